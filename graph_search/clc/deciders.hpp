#pragma once

#include "graph_search/shared/search_graph.hpp"

#include <array>
#include <numbers>

namespace conelane {

/// turning_measure of an angle by multiples of its absolute sine and of its cosine.
[[nodiscard]] inline double turning_measure_of(double sine, double cosine) {
    const double sum = sine + std::abs(cosine);
    if (sum == 0.0) return 0.0;
    return cosine >= 0.0 ? sine / sum : 2.0 - sine / sum;
}
/// A number that grows with the absolute angle between two directions: 0 for straight on, 1 for a right
/// angle, 2 for a turn back; 0 if a direction has no length. Cheaper than the angle and as exact.
[[nodiscard]] inline double turning_measure(const Point& before, const Point& after) {
    return turning_measure_of(std::abs(cross(before, after)), before.dot(after));
}
/// turning_measure of an absolute angle in [0, pi] rad.
[[nodiscard]] inline double turning_measure(double angle_rad) {
    return turning_measure_of(std::abs(std::sin(angle_rad)), std::cos(angle_rad));
}
/// The absolute angle of a turning_measure [rad], wrong by less than kNearlyAngle_rad. Cheaper than the
/// angle.
[[nodiscard]] inline double nearly_angle_rad(double turning_measure) {
    // In [0, 1], the measure m belongs to the angle pi/4 + atan(2 m - 1).
    const bool back = turning_measure > 1.0;
    const double x = 2.0 * turning_measure - (back ? 3.0 : 1.0);
    const double x2 = x * x;
    // Abramowitz and Stegun, 4.4.47.
    const double arc =
        x * (0.9998660 + x2 * (-0.3302995 + x2 * (0.1801410 + x2 * (-0.0851330 + x2 * 0.0208351))));
    return arc + (back ? 0.75 : 0.25) * std::numbers::pi;
}
inline constexpr double kNearlyAngle_rad = 2e-5;

/// How far a boundary may step from a vertex: to its nearest neighbours only, where cones are dense. Beyond
/// the paper: with steps of up to 10 m a cone may have over 100 neighbours, most of them of other parts of
/// the course. Features still count all neighbours.
class StepReach {
  public:
    /// `most`: neighbours of a vertex that a step may lead to, and those as near as the last one of them; 0:
    /// all. `graph` must outlive the use of this object. Keeps memory from call to call.
    void reset(const SearchGraph& graph, std::size_t most);
    /// Square of the largest length of a step from the vertex, infinity if all neighbours are allowed [m^2].
    [[nodiscard]] double squared_m2(Vertex vertex) {
        if (squared_m2_[vertex] < 0.0) find(vertex);
        return squared_m2_[vertex];
    }
    /// The places of the allowed neighbours among all neighbours of the vertex, ascending. Valid until the
    /// next call.
    [[nodiscard]] std::span<const std::uint32_t> steps(Vertex vertex) {
        if (squared_m2_[vertex] < 0.0) find(vertex);
        return std::span(allowed_).subspan(first_[vertex], count_[vertex]);
    }
    /// Whether a vertex that was asked for has neighbours that are not allowed.
    [[nodiscard]] bool left_out() const { return left_out_; }

  private:
    void find(Vertex vertex);

    const SearchGraph* graph_ = nullptr;
    std::size_t most_ = 0;
    bool left_out_ = false;
    std::vector<double> squared_m2_;    ///< by vertex; negative until it is asked for
    std::vector<std::uint32_t> first_;  ///< by vertex, in `allowed_`
    std::vector<std::uint32_t> count_;  ///< by vertex
    std::vector<std::uint32_t> allowed_;
    std::vector<double> distances_m2_;
    std::vector<double> nearest_m2_;
};

/// A vertex that may come next on a boundary.
struct NextVertex {
    Vertex vertex;
    SearchGraph::DirectedEdge edge;  ///< the edge that leads to it
    double turning;                  ///< turning_measure of the boundary's angle at it
    double cost;                     ///< decides the order
};

/// Next-vertex decider NVD, equation (3) of the CLC paper: neighbours of a boundary's last vertex by the
/// absolute angle to its last segment, smallest first; ties by vertex. The order depends only on the last two
/// vertices, so it is computed once for each directed edge that the search meets.
///
/// With a distance weight, the cost is the turning_measure plus the vertex's distance as a share of d_max,
/// times the weight. Then the nearest of several vertices almost straight ahead comes first. Equation (3),
/// weight 0, may skip it, and may take a false positive far off for the next cone of a bend.
class NextVertexDecider {
  public:
    /// A range of `options`.
    struct Range {
        std::uint32_t begin;
        std::uint32_t end;
    };

    /// Clears the cache; `graph` and `reach` must outlive the use of this object. `reach`: farther neighbours
    /// are left out; null: none is.
    void reset(const SearchGraph& graph, double distance_weight_per_m = 0.0, StepReach* reach = nullptr);

    /// Neighbours of a first vertex, ordered by their angle with the car's heading (a unit vector).
    [[nodiscard]] Range after_start(Vertex start, const Point& heading);
    /// Neighbours of `to`, ordered by their angle with the segment from `from`, which `edge` joins to `to`.
    [[nodiscard]] Range after(Vertex from, Vertex to, SearchGraph::DirectedEdge edge) {
        if (ranges_[edge].begin == kUnknown)
            ranges_[edge] = sorted(to, graph_->position(to) - graph_->position(from));
        return ranges_[edge];
    }
    /// Size of all ranges so far.
    [[nodiscard]] std::size_t option_count() const { return options_.size(); }
    [[nodiscard]] const NextVertex& option(std::uint32_t index) const { return options_[index]; }

  private:
    static constexpr std::uint32_t kUnknown = ~std::uint32_t{0};

    [[nodiscard]] Range sorted(Vertex vertex, const Point& direction);

    const SearchGraph* graph_ = nullptr;
    StepReach* reach_ = nullptr;
    StepReach all_;  ///< used if no reach is given
    double distance_weight_per_m_ = 0.0;
    std::vector<Range> ranges_;  ///< by directed edge
    std::vector<NextVertex> options_;
};

/// What the left-right decider needs of a boundary: its last point, the direction of its last segment (the
/// car's heading if there is none), and the next candidate point.
struct BoundaryTip {
    Point last;
    Point direction;
    Point next;
};

/// |theta_r - theta_l| of equation (4), as a number in [0, 4] that grows with it. theta_l and theta_r are the
/// absolute angles between the last segments and the lines from each boundary's last point to the other's.
/// (With signs, the difference would be about pi for any boundaries.)
[[nodiscard]] double advance_deviation(const Point& left_last, const Point& left_direction,
                                       const Point& right_last, const Point& right_direction);

/// Left-right decider LRD, equation (5): the side whose extension keeps both boundaries more equally
/// advanced. In the printed equation, the order of the sides decides ties; here `tie` is returned, so a scene
/// and its mirror image are searched alike.
[[nodiscard]] Side left_right_decision(const std::array<BoundaryTip, 2>& tips, Side tie);

}  // namespace conelane
