#pragma once

#include "solvers/path_pair/graph/arc_graph.hpp"

#include <array>
#include <span>
#include <vector>

namespace conelane::path_pair {

/// The best lane graph so far. Takes nothing that breaks a constraint.
class Incumbent {
  public:
    void reset(const ArcGraph& graph, double cutoff);

    /// Legs as arcs of the arc graph, each from its start to its end. True where they are a lane graph, near
    /// cones at the starts and (17) at the ends apart, that costs less than the incumbent or the first
    /// cutoff.
    bool offer(std::span<const int> first, std::span<const int> second);

    [[nodiscard]] bool found() const { return found_; }
    /// Only what costs less is of interest.
    [[nodiscard]] double cutoff() const { return cutoff_; }
    void set_cutoff(double cutoff) { cutoff_ = cutoff; }
    /// Edges of the arc graph.
    [[nodiscard]] std::span<const int> edges() const { return edges_; }
    /// Arcs of the arc graph, as they were offered.
    [[nodiscard]] const std::array<std::vector<int>, 2>& legs() const { return legs_; }

    /// (29) of a leg.
    [[nodiscard]] double leg_cost(std::span<const int> leg) const;

  private:
    const ArcGraph* graph_ = nullptr;
    double cutoff_ = 0.0;
    bool found_ = false;
    std::vector<int> edges_;
    std::array<std::vector<int>, 2> legs_;
    std::vector<int> candidate_;
    std::vector<char> visited_;
};

}  // namespace conelane::path_pair
