#include "model/shape_costs.hpp"

#include "model/geometry.hpp"

namespace conelane {
namespace {

double square(double value) {
    return value * value;
}

struct PlacedEdge {
    std::size_t number;
    Point middle;
    Point direction;  ///< unit length; zero for an edge of zero length
    double length_m;
    double strip = 0.0;  ///< of PlacedEdges
};

PlacedEdge placed(const Scene& scene, std::size_t i, std::size_t j, std::size_t number) {
    const Point& from = scene.cones[i].position;
    const Point& to = scene.cones[j].position;
    const double length = (to - from).norm();
    return {number, 0.5 * (from + to), length > 0.0 ? Point((to - from) / length) : Point(0.0, 0.0), length};
}

bool share_a_cone(const ProblemEdge& a, const Edge& b) {
    return a.i == b.i || a.i == b.j || a.j == b.i || a.j == b.j;
}

/// Edges by where their midpoints are: in strips of the plane, and along each strip.
class PlacedEdges {
  public:
    PlacedEdges(std::vector<PlacedEdge> edges, double strip_m) : edges_(std::move(edges)), strip_m_(strip_m) {
        for (PlacedEdge& edge : edges_) edge.strip = strip(edge.middle);
        std::ranges::sort(edges_, {}, [](const PlacedEdge& edge) {
            return std::tuple(edge.strip, edge.middle.x(), edge.number);
        });
    }

    /// Those of a square of two strips' widths around the place, as a list for each strip that it meets.
    [[nodiscard]] std::array<std::span<const PlacedEdge>, 3> around(const Point& place) const {
        std::array<std::span<const PlacedEdge>, 3> lists;
        for (int k = 0; k < 3; ++k) {
            const double in_strip = strip(place) + k - 1;
            const auto key = [](const PlacedEdge& edge) { return std::pair(edge.strip, edge.middle.x()); };
            const auto begin =
                std::ranges::lower_bound(edges_, std::pair(in_strip, place.x() - strip_m_), {}, key);
            const auto end =
                std::ranges::upper_bound(edges_, std::pair(in_strip, place.x() + strip_m_), {}, key);
            lists[static_cast<std::size_t>(k)] = {begin, end};
        }
        return lists;
    }

  private:
    [[nodiscard]] double strip(const Point& place) const { return std::floor(place.y() / strip_m_); }

    std::vector<PlacedEdge> edges_;
    double strip_m_;
};

/// By edge: the measure of the edge that faces it best, at most 1. `cost_of` gets along_squared, across, sine
/// and longer_m of two edges; `along` and `across` belong to the way between their midpoints, seen from the
/// first edge. It is at least 1 if the midpoints are farther apart than `reach_m`.
template <typename CostOf>
std::vector<double> facing(const Scene& scene, std::span<const ProblemEdge> edges,
                           std::span<const Edge> facers, double reach_m, const CostOf& cost_of,
                           const std::function<bool(std::size_t)>& stop) {
    std::vector<PlacedEdge> places;
    places.reserve(facers.size());
    for (std::size_t f = 0; f < facers.size(); ++f)
        places.push_back(placed(scene, facers[f].i, facers[f].j, f));
    const PlacedEdges placed_facers(std::move(places), reach_m);
    std::vector<double> costs(edges.size(), 1.0);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const PlacedEdge place = placed(scene, edges[e].i, edges[e].j, e);
        if (place.direction == Point()) continue;
        const auto lists = placed_facers.around(place.middle);
        if (stop && stop(lists[0].size() + lists[1].size() + lists[2].size())) return costs;
        double least = 1.0;
        for (const std::span<const PlacedEdge> list : lists) {
            for (const PlacedEdge& facer : list) {
                const Point way = facer.middle - place.middle;
                const double across = cross(place.direction, way);
                const double along_squared = std::max(0.0, way.squaredNorm() - square(across));
                const double cost = cost_of(along_squared, across, cross(place.direction, facer.direction),
                                            place.length_m - facer.length_m);
                if (cost < least && !share_a_cone(edges[e], facers[facer.number])) least = cost;
            }
        }
        costs[e] = least;
    }
    return costs;
}

}  // namespace

std::vector<double> facing_costs(const Scene& scene, std::span<const ProblemEdge> edges,
                                 std::span<const Edge> facers, const RldParameters& p,
                                 const std::function<bool(std::size_t)>& stop) {
    const auto cost = [&p](double along_squared, double across, double sine, double longer_m) {
        const double unlike = square(sine / p.facing_angle_rad) + square(longer_m / p.facing_length_m);
        return (along_squared + square(std::abs(across) - p.lane_width_m)) / square(p.facing_distance_m) +
               unlike;
    };
    return facing(scene, edges, facers, p.lane_width_m + p.facing_distance_m, cost, stop);
}

std::vector<double> facing_at_any_width(const Scene& scene, std::span<const ProblemEdge> edges,
                                        std::span<const Edge> facers,
                                        const std::function<bool(std::size_t)>& stop) {
    constexpr double kReach_m = 7.7;  // beyond it the cost is above 1
    const auto cost = [](double along_squared, double across, double sine, double /*longer_m*/) {
        constexpr double kAlong_m = 4.0;
        constexpr double kNarrowest_m = 2.5;
        constexpr double kWidest_m = 5.5;
        constexpr double kSine = 0.6;
        const double width = std::abs(across);
        const double off = std::max(0.0, width - kWidest_m) + std::max(0.0, kNarrowest_m - width);
        return along_squared / square(kAlong_m) + square(off) + square(sine / kSine);
    };
    return facing(scene, edges, facers, kReach_m, cost, stop);
}

double unevenness(double before_m, double after_m, const RldParameters& parameters) {
    return square((before_m - after_m) / parameters.d_t);
}

double near_end_fit(const Scene& scene, const Point& cone, const RldParameters& p) {
    return std::max(0.0, 1.0 - square((std::abs(scene.pose.left_m(cone)) - 0.5 * p.lane_width_m) / p.d_t));
}

}  // namespace conelane
