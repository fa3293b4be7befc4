#pragma once

#include "solvers/path_pair/bound/pair_relaxation.hpp"
#include "solvers/path_pair/path_pair_options.hpp"
#include "solvers/path_pair/search/node.hpp"

namespace conelane::path_pair {

/// Splits a node where its relaxation is least certain: on ends first, because with both ends free, half of
/// the relaxed optimum may run along one boundary and half along the other. Then on the edge whose use is
/// most fractional.
class Brancher {
  public:
    Brancher(const ArcGraph& graph, const BranchingTuning& tuning) : graph_(graph), tuning_(tuning) {}

    /// Nothing if every edge of the residual graph is decided.
    [[nodiscard]] Branching choose(const ResidualGraph& graph, const PairRelaxation& relaxation,
                                   const Decisions& decisions, const WalkUsage& usage) const;
    /// Whether to search the branch with the end, or the edge, before the other one.
    [[nodiscard]] bool is_in_first(const Branching& branching) const {
        return branching.on == Branching::On::end || branching.use >= tuning_.min_use_in_first;
    }
    /// The rest of the graph in the branch with it, or without it.
    void branch(const ResidualGraph& source, const Branching& branching, bool in, ResidualGraph& target);

  private:
    void branch_on_end(const ResidualGraph& source, int cone, bool in);
    void branch_on_edge(const ResidualGraph& source, int edge, bool in);

    const ArcGraph& graph_;
    const BranchingTuning& tuning_;
    std::vector<int> order_;  ///< arcs that stay
    std::vector<char> keep_successor_;
    std::vector<int> index_;
};

}  // namespace conelane::path_pair
