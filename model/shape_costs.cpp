#include "model/shape_costs.hpp"

#include "model/geometry.hpp"

#include <algorithm>
#include <cmath>

namespace conelane {
namespace {

double square(double value) {
    return value * value;
}

struct PlacedEdge {
    Point middle;
    Point direction;  ///< of length one; zero where the edge has no length
    double length_m;
};

PlacedEdge placed(const Scene& scene, const ProblemEdge& edge) {
    const Point& from = scene.cones[edge.i].position;
    const Point& to = scene.cones[edge.j].position;
    const double length = (to - from).norm();
    return {0.5 * (from + to), length > 0.0 ? Point((to - from) / length) : Point(0.0, 0.0), length};
}

}  // namespace

double unevenness(double before_m, double after_m, const RldParameters& parameters) {
    return square((before_m - after_m) / parameters.d_t);
}

std::vector<double> facing_costs(const Scene& scene, std::span<const ProblemEdge> edges,
                                 const RldParameters& p, const std::function<bool(std::size_t)>& stop) {
    std::vector<PlacedEdge> places;
    places.reserve(edges.size());
    for (const ProblemEdge& edge : edges) places.push_back(placed(scene, edge));
    std::vector<double> costs(edges.size(), 1.0);
    const double reach = p.d_w + p.d_v;  // beyond it the cost is above 1
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (stop && stop(edges.size() - e)) return costs;
        const ProblemEdge& edge = edges[e];
        for (std::size_t other = e + 1; other < edges.size(); ++other) {
            const Point way = places[other].middle - places[e].middle;
            const double distance_squared = way.squaredNorm();
            if (distance_squared > square(reach)) continue;
            const ProblemEdge& facing = edges[other];
            if (edge.i == facing.i || edge.i == facing.j || edge.j == facing.i || edge.j == facing.j)
                continue;
            const double unlike = square(cross(places[e].direction, places[other].direction) / p.theta_v) +
                                  square((places[e].length_m - places[other].length_m) / p.d_l);
            const auto cost = [&](const Point& direction) {
                const double across = cross(direction, way);
                const double along_squared = std::max(0.0, distance_squared - square(across));
                return (along_squared + square(std::abs(across) - p.d_w)) / square(p.d_v) + unlike;
            };
            if (!facing.high_cost) costs[e] = std::min(costs[e], cost(places[e].direction));
            if (!edge.high_cost) costs[other] = std::min(costs[other], cost(places[other].direction));
        }
        if (places[e].direction.isZero()) costs[e] = 1.0;
    }
    return costs;
}

double near_end_fit(const Scene& scene, const Point& cone, const RldParameters& p) {
    return std::max(0.0, 1.0 - square((std::abs(scene.pose.left_m(cone)) - 0.5 * p.d_w) / p.d_t));
}

}  // namespace conelane
