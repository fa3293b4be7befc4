#pragma once

#include "solvers/path_pair/graph/arc_graph.hpp"

#include <array>

namespace conelane::path_pair {

/// The best lane graph so far. It accepts nothing that breaks a constraint, from any caller.
class Incumbent {
  public:
    explicit Incumbent(const ArcGraph& graph) : graph_(&graph) {}

    /// `tolerance`: a search leaves out what is not cheaper by more than this.
    void reset(double cutoff, double tolerance);

    /// Legs as arcs of the arc graph. A leg between a near cone and a far one has to run to the far one.
    /// Returns true if the legs are a lane graph that costs less than the incumbent or the first cutoff. The
    /// caller has to check whether the pairing allows its ends.
    bool offer(std::span<const int> first, std::span<const int> second);

    [[nodiscard]] bool found() const { return found_; }
    /// Only lane graphs of lower cost are of use.
    [[nodiscard]] double cutoff() const { return cutoff_; }
    void set_cutoff(double cutoff) { cutoff_ = cutoff; }
    [[nodiscard]] double tolerance() const { return tolerance_; }
    /// Below it a search has to look.
    [[nodiscard]] double limit() const { return cutoff_ - tolerance_; }
    /// Edges of the arc graph.
    [[nodiscard]] std::span<const int> edges() const { return edges_; }
    /// Arcs of the arc graph, as they were offered.
    [[nodiscard]] const std::array<std::vector<int>, 2>& legs() const { return legs_; }
    /// Whether both legs run from a near cone to a far one. Otherwise one is between near cones and one
    /// between far ones, which only the pairing `paper` allows: it is not a pair of legs of the near-far
    /// system.
    [[nodiscard]] bool goes_far() const;

    /// (29) of a leg.
    [[nodiscard]] double leg_cost(std::span<const int> leg) const;

  private:
    [[nodiscard]] bool has_ends_of_a_lane(std::span<const int> first, std::span<const int> second) const;

    const ArcGraph* graph_;
    double cutoff_ = 0.0;
    double tolerance_ = 0.0;
    bool found_ = false;
    std::vector<int> edges_;
    std::array<std::vector<int>, 2> legs_;
    std::vector<int> candidate_;
    std::vector<char> visited_;
};

}  // namespace conelane::path_pair
