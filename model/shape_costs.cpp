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
    Point direction;  ///< unit length; zero for an edge of zero length
    double length_m;
};

PlacedEdge placed(const Scene& scene, const ProblemEdge& edge) {
    const Point& from = scene.cones[edge.i].position;
    const Point& to = scene.cones[edge.j].position;
    const double length = (to - from).norm();
    return {0.5 * (from + to), length > 0.0 ? Point((to - from) / length) : Point(0.0, 0.0), length};
}

/// Of two edges. `along` and `across` belong to the way between their midpoints, seen from the first edge.
using CostOfFacing = double (*)(const RldParameters& p, double along_squared, double across, double sine,
                                double longer_m);

/// By edge: the measure of the edge that faces it best; 1 if no midpoint is within `reach_m`.
std::vector<double> facing(const Scene& scene, std::span<const ProblemEdge> edges, const RldParameters& p,
                           double reach_m, CostOfFacing cost_of,
                           const std::function<bool(std::size_t)>& stop) {
    const auto may_face = [](const ProblemEdge& edge) { return !edge.high_cost && !edge.gap; };
    std::vector<PlacedEdge> places;
    places.reserve(edges.size());
    for (const ProblemEdge& edge : edges) places.push_back(placed(scene, edge));
    std::vector<double> costs(edges.size(), 1.0);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (stop && stop(edges.size() - e)) return costs;
        const ProblemEdge& edge = edges[e];
        for (std::size_t other = e + 1; other < edges.size(); ++other) {
            const Point way = places[other].middle - places[e].middle;
            const double distance_squared = way.squaredNorm();
            if (distance_squared > square(reach_m)) continue;
            const ProblemEdge& beside = edges[other];
            if (edge.i == beside.i || edge.i == beside.j || edge.j == beside.i || edge.j == beside.j)
                continue;
            const double sine = cross(places[e].direction, places[other].direction);
            const double longer_m = places[e].length_m - places[other].length_m;
            const auto cost = [&](const Point& direction) {
                const double across = cross(direction, way);
                const double along_squared = std::max(0.0, distance_squared - square(across));
                return cost_of(p, along_squared, across, sine, longer_m);
            };
            if (may_face(beside)) costs[e] = std::min(costs[e], cost(places[e].direction));
            if (may_face(edge)) costs[other] = std::min(costs[other], cost(places[other].direction));
        }
        if (places[e].direction.isZero()) costs[e] = 1.0;
    }
    return costs;
}

}  // namespace

std::vector<double> facing_costs(const Scene& scene, std::span<const ProblemEdge> edges,
                                 const RldParameters& parameters,
                                 const std::function<bool(std::size_t)>& stop) {
    const auto cost = [](const RldParameters& p, double along_squared, double across, double sine,
                         double longer_m) {
        const double unlike = square(sine / p.theta_v) + square(longer_m / p.d_l);
        return (along_squared + square(std::abs(across) - p.d_w)) / square(p.d_v) + unlike;
    };
    return facing(scene, edges, parameters, parameters.d_w + parameters.d_v, cost, stop);
}

std::vector<double> facing_at_any_width(const Scene& scene, std::span<const ProblemEdge> edges,
                                        const std::function<bool(std::size_t)>& stop) {
    constexpr double kAlong_m = 4.0;
    constexpr double kWidest_m = 5.5;
    constexpr double kReach_m = 7.7;  // beyond it the cost is above 1
    const auto cost = [](const RldParameters& /*p*/, double along_squared, double across, double sine,
                         double /*longer_m*/) {
        constexpr double kNarrowest_m = 2.5;
        constexpr double kSine = 0.6;
        const double width = std::abs(across);
        const double off = std::max(0.0, width - kWidest_m) + std::max(0.0, kNarrowest_m - width);
        return along_squared / square(kAlong_m) + square(off) + square(sine / kSine);
    };
    return facing(scene, edges, {}, kReach_m, cost, stop);
}

double unevenness(double before_m, double after_m, const RldParameters& parameters) {
    return square((before_m - after_m) / parameters.d_t);
}

double near_end_fit(const Scene& scene, const Point& cone, const RldParameters& p) {
    return std::max(0.0, 1.0 - square((std::abs(scene.pose.left_m(cone)) - 0.5 * p.d_w) / p.d_t));
}

}  // namespace conelane
