#pragma once

#include "solvers/path_pair/incumbent.hpp"
#include "solvers/path_pair/leg_bounds.hpp"
#include "solvers/path_pair/leg_search.hpp"
#include "solvers/path_pair/pair_relaxation.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace conelane::path_pair {

/// Incumbents from single legs: a leg given, the best other one in what it leaves. Its own cones and all
/// edges incompatible with it are gone. Nothing couples the other leg any more, so its bound is by true
/// costs, with prices on cones against cycles alone.
class PairCompletion {
  public:
    void bind(const ArcGraph& graph, PairRelaxation& relaxation, Incumbent& incumbent, SearchClock& clock);

    /// Looks for an incumbent around a walk of the relaxation: the walk, or the best leg near by where it is
    /// no path, completed by the best second leg, which is then completed in turn.
    void complete(const ResidualGraph& residual, int kind, std::span<const int> walk, double tolerance,
                  std::int64_t budget);

  private:
    bool second_legs(const ResidualGraph& residual, int kind, std::span<const int> first, double tolerance,
                     std::int64_t& budget);
    void leave_out(const ResidualGraph& residual, int second_kind, std::span<const int> first);
    double price_second(const ResidualGraph& residual, int second_kind);
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
    std::vector<double> second_price_;  ///< by cone
    std::vector<double> second_reduced_;
    std::vector<double> second_forward_;
    std::vector<int> second_before_;
    std::vector<int> second_walk_;
    std::vector<int> cycle_;
    std::vector<int> visits_;
    std::vector<char> taken_;
    std::vector<std::uint64_t> blocked_;
    std::vector<int> first_arcs_;
    std::vector<int> second_arcs_;
    std::vector<int> leg_;
    std::vector<int> best_second_;
};

}  // namespace conelane::path_pair
