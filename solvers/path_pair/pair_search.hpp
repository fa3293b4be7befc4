#pragma once

#include "solvers/path_pair/incumbent.hpp"
#include "solvers/path_pair/leg_bounds.hpp"
#include "solvers/path_pair/leg_search.hpp"
#include "solvers/path_pair/pair_relaxation.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace conelane::path_pair {

/// Pairs of legs by enumeration, below a cutoff U of the incumbent.
///
/// Half-gap rule. Let P and Q be the legs of a pair with reduced costs c(P) + c(Q) < U' = U + offset, ends f
/// and g, and let slack(P) = c(P) - F(f). Say slack(P) <= slack(Q). Then 2 slack(P) < U' - F(f) - F(g), and
/// as h(f) <= F(g),
///     c(P) + (h(f) - F(f)) / 2 < U' / 2.
/// So it is enough to enumerate the legs P of this inequality (backward labels with (h - F) / 2 as the cost
/// of ending), each completed by all legs Q of c(Q) < U' - c(P) in what P leaves: its own cones and all edges
/// incompatible with it are gone, and one backward pass bounds the rest. With unlike kinds of legs, both have
/// to be tried as P.
class PairSearch {
  public:
    void bind(const ArcGraph& graph, PairRelaxation& relaxation, Incumbent& incumbent);

    /// Every pair that costs less than the incumbent by more than `tolerance`. False where the budget of
    /// tried arcs ran out first. Precondition: forward and backward labels of the residual graph.
    bool exhaust(const ResidualGraph& residual, double tolerance, std::int64_t budget);

    /// Looks for an incumbent around a walk of the relaxation: the walk, or the best leg near by where it is
    /// no path, completed by the best second leg, which is then completed in turn.
    void complete(const ResidualGraph& residual, int kind, std::span<const int> walk, double tolerance,
                  std::int64_t budget);

  private:
    bool exhaust_kind(const ResidualGraph& residual, int kind, double tolerance, std::int64_t& budget);
    bool second_legs(const ResidualGraph& residual, int kind, std::span<const int> first, double first_cost,
                     double tolerance, std::int64_t& budget);
    [[nodiscard]] double cutoff(double tolerance) const;
    [[nodiscard]] bool is_leg(const ResidualGraph& residual, std::span<const int> walk);
    void to_arcs(const ResidualGraph& residual, std::span<const int> leg, std::vector<int>& arcs) const;

    const ArcGraph* graph_ = nullptr;
    PairRelaxation* relaxation_ = nullptr;
    Incumbent* incumbent_ = nullptr;
    LegBounds bounds_;
    LegSearch first_search_;
    LegSearch second_search_;
    std::vector<double> half_end_;
    std::vector<double> half_backward_;
    std::vector<char> usable_;
    std::vector<double> second_end_;
    std::vector<double> second_start_;
    std::vector<double> second_backward_;
    std::vector<char> taken_;
    std::vector<std::uint64_t> blocked_;
    std::vector<int> first_arcs_;
    std::vector<int> second_arcs_;
    std::vector<int> leg_;
    std::vector<int> best_second_;
};

}  // namespace conelane::path_pair
