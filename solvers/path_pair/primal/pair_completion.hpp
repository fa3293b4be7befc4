#pragma once

#include "solvers/path_pair/bound/leg_bounds.hpp"
#include "solvers/path_pair/bound/leg_search.hpp"
#include "solvers/path_pair/bound/pair_relaxation.hpp"
#include "solvers/path_pair/primal/incumbent.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace conelane::path_pair {

/// Incumbents from single legs: for a given leg, the best second one. The cones of the given leg and all
/// edges incompatible with it are left out. Nothing else couples the second leg, so its bound needs true
/// costs and multipliers on cones against cycles, nothing more.
class PairCompletion {
  public:
    void bind(const ArcGraph& graph, PairRelaxation& relaxation, Incumbent& incumbent, SearchClock& clock);

    /// Looks for an incumbent around a walk of the relaxation. The walk, or the best leg where it is no path,
    /// gets the best second leg; that leg is then the given one, and so on.
    void complete(const ResidualGraph& residual, int kind, std::span<const int> walk, double tolerance,
                  std::int64_t budget);

  private:
    bool second_legs(const ResidualGraph& residual, int kind, std::span<const int> first, double tolerance,
                     std::int64_t& budget);
    void leave_out(const ResidualGraph& residual, int second_kind, std::span<const int> first);
    /// Reduced costs of the second leg; returns their offset.
    double reduce_second_costs(const ResidualGraph& residual, int second_kind);
    [[nodiscard]] double cutoff(double tolerance) const;
    [[nodiscard]] bool is_leg(const ResidualGraph& residual, std::span<const int> walk);
    void to_arcs(const ResidualGraph& residual, std::span<const int> leg, std::vector<int>& arcs) const;

    const ArcGraph* graph_ = nullptr;
    PairRelaxation* relaxation_ = nullptr;
    Incumbent* incumbent_ = nullptr;
    SearchClock* clock_ = nullptr;
    LegBounds bounds_;
    LegSearch first_search_;
    LegSearch second_search_;
    std::vector<char> usable_;
    std::vector<double> second_end_;
    std::vector<double> second_start_;
    std::vector<double> second_backward_;
    std::vector<double> second_multiplier_;  ///< by cone
    std::vector<double> second_reduced_;
    std::vector<double> second_forward_;
    std::vector<int> second_before_;
    std::vector<int> second_walk_;
    std::vector<int> cycles_;
    std::vector<int> visits_;
    std::vector<char> taken_;
    std::vector<std::uint64_t> blocked_;
    std::vector<int> first_arcs_;
    std::vector<int> second_arcs_;
    std::vector<int> leg_;
    std::vector<int> best_second_;
};

}  // namespace conelane::path_pair
