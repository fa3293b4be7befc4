#pragma once

#include "solvers/path_pair/primal/incumbent.hpp"
#include "solvers/path_pair/primal/second_leg_bound.hpp"

namespace conelane::path_pair {

/// Incumbents from single legs: for a given leg, the best second one.
class PairCompletion {
  public:
    /// `second`: of the same graph; several relaxations may share it.
    PairCompletion(const ArcGraph& graph, PairRelaxation& relaxation, Incumbent& incumbent,
                   SecondLegBound& second, SearchClock& clock)
        : graph_(graph), relaxation_(relaxation), incumbent_(incumbent), second_(second), clock_(clock) {}

    /// Looks for an incumbent around a walk of the relaxation. The walk, or the best leg if the walk is not a
    /// path, gets the best second leg; then that leg is the given one, and so on. `budget`: arcs tried in
    /// each search for a leg. A heuristic: if the budget runs out, better pairs may be missed.
    void complete(const ResidualGraph& residual, int kind, std::span<const int> walk, std::int64_t budget);

  private:
    [[nodiscard]] bool is_leg(const ResidualGraph& residual, std::span<const int> walk);
    /// The cheapest leg found within the budget; empty if none is found.
    void find_first_leg(const ResidualGraph& residual, int kind, std::int64_t budget);
    /// Offers legs of the other kind that go with leg_. best_second_ is the last accepted one, or empty.
    void find_second_leg(const ResidualGraph& residual, int kind, std::int64_t budget);
    static void to_arcs(const ResidualGraph& residual, std::span<const int> leg, std::vector<int>& arcs);

    const ArcGraph& graph_;
    PairRelaxation& relaxation_;
    Incumbent& incumbent_;
    SecondLegBound& second_;
    SearchClock& clock_;
    LegSearch search_;
    std::vector<int> leg_;  ///< the given one
    std::vector<int> best_second_;
    std::vector<int> first_arcs_;
    std::vector<int> second_arcs_;
    std::vector<char> visited_;
};

}  // namespace conelane::path_pair
