#pragma once

#include "solvers/path_pair/bound/multipliers.hpp"
#include "solvers/path_pair/bound/pair_relaxation.hpp"

#include <span>
#include <vector>

namespace conelane::path_pair {

/// Use of edges and ends by the two walks of the bound: in the last step of an ascent, and averaged over its
/// steps.
class WalkUsage {
  public:
    /// Forgets earlier steps.
    void reset(const ArcGraph& graph);
    /// Adds a step. `memory`: the share of the averages that is kept. Precondition: the relaxation was
    /// evaluated on the residual graph.
    void count(const ArcGraph& graph, const CliquePool& cliques, const ResidualGraph& residual,
               PairRelaxation& relaxation, double memory);

    [[nodiscard]] const Usage& last() const { return last_; }
    /// By edge, averaged: 1 if the two legs together always use it once.
    [[nodiscard]] std::span<const double> edges() const { return edges_; }
    /// By cone, averaged: legs that end there.
    [[nodiscard]] std::span<const double> ends() const { return ends_; }

  private:
    Usage last_;
    std::vector<double> edges_;
    std::vector<double> ends_;
    std::vector<int> times_;  ///< by edge, in the last step
};

}  // namespace conelane::path_pair
