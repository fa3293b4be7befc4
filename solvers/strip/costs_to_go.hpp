#pragma once

#include "solvers/strip/strip_states.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace conelane {

class Deadline;

/// The least cost from every state to an end, where a strip may use a cone again. Each use of a cone costs
/// its multiplier too, so that their sum less bounds the strips that use no cone twice. A loop of negative
/// cost raises the multipliers of its cones until it costs something.
class CostsToGo {
  public:
    /// Multipliers of 0. Both must outlive it.
    void begin(const StripProblem& problem, const StripStates& states);
    /// False if the deadline has passed, or if loops of negative cost do not end: then the costs are those of
    /// some strips, not the least.
    [[nodiscard]] bool compute(const Deadline& deadline);

    [[nodiscard]] double of(const StripState& state) const { return costs_[states_->index(state)]; }
    [[nodiscard]] const std::vector<double>& multipliers() const { return multipliers_; }
    [[nodiscard]] double sum() const { return sum_; }

  private:
    struct Cheapest {
        std::optional<StripStep> step;  ///< absent: the strip ends here
        double cost = StripProblem::kForbidden;
    };
    [[nodiscard]] Cheapest cheapest(const StripState& state) const;
    bool relax(std::uint32_t rung);
    void relax_left(const StripTriangle& triangle, std::size_t rows, std::size_t columns);
    void relax_right(const StripTriangle& triangle, std::size_t rows, std::size_t columns);
    bool raise_loops();
    bool raise_loop_from(StripState state);

    const StripProblem* problem_ = nullptr;
    const StripStates* states_ = nullptr;
    std::vector<double> costs_;  ///< by state
    std::vector<double> multipliers_;
    double sum_ = 0.0;
    std::vector<std::vector<std::uint32_t>> before_;  ///< by rung those that lead to it
    std::vector<char> is_stale_;                      ///< by rung: a rung that it leads to has changed
    std::vector<double> row_;                         ///< the new costs of a rung
};

}  // namespace conelane
