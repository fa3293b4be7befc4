#pragma once

#include "solvers/path_pair/graph/residual_graph.hpp"

namespace conelane::path_pair {

/// Sets of a residual graph's edges, numbered without gaps, as rows of words() words. A leg that takes an arc
/// excludes edges for itself and for the other leg: those incompatible with it, those at the cone that it
/// leaves, and, for arcs taken before it, those at the cone that it enters.
class EdgeSets {
  public:
    /// The sets are invalid once the clock has expired.
    void assign(const ArcGraph& graph, const ResidualGraph& residual, SearchClock& clock);

    [[nodiscard]] std::size_t words() const { return words_; }
    /// Number of the edge of an arc.
    [[nodiscard]] std::size_t number(int arc) const { return to_index(number_[to_index(arc)]); }
    /// Edges that are excluded after the arc, and for the other leg.
    [[nodiscard]] const std::uint64_t* lost_after(int arc) const {
        return after_.data() + to_index(arc) * words_;
    }
    /// Edges that cannot have been in the leg before the arc, nor be in the other leg.
    [[nodiscard]] const std::uint64_t* lost_before(int arc) const {
        return before_.data() + to_index(arc) * words_;
    }
    [[nodiscard]] static bool contains(const std::uint64_t* set, std::size_t number) {
        return (set[number / 64] >> (number % 64) & 1) != 0;
    }

  private:
    std::size_t words_ = 0;
    std::vector<int> number_;          ///< by arc
    std::vector<int> number_of_edge_;  ///< -1 if the edge is not in the residual graph
    std::vector<int> edges_;           ///< by number
    std::vector<std::uint64_t> at_cone_;
    std::vector<std::uint64_t> excluded_;  ///< by number, the edges incompatible with it
    std::vector<std::uint64_t> after_;
    std::vector<std::uint64_t> before_;
};

}  // namespace conelane::path_pair
