#pragma once

#include "graph_search/clc/step_reach.hpp"
#include "graph_search/shared/search_graph.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace conelane {

/// A number that grows with the absolute angle between two directions: 0 for straight on, 1 for a right
/// angle, 2 for a turn back; 0 if a direction has no length. Cheaper than the angle and as exact.
[[nodiscard]] double turning_measure(const Point& before, const Point& after);
/// turning_measure of an absolute angle in [0, pi] rad.
[[nodiscard]] double turning_measure(double angle_rad);

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
    double distance_weight_per_m_ = 0.0;
    std::vector<Range> ranges_;  ///< by directed edge
    std::vector<NextVertex> options_;
};

}  // namespace conelane
