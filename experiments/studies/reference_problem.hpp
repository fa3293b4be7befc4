#pragma once

#include "conelane/rld_solver.hpp"
#include "conelane/scene.hpp"

#include <memory>
#include <span>

namespace conelane::experiments {

/// One scene of a generated course, solved by path-pair again and again: the same work whatever a study
/// measures. Run between its blocks, it shows how steady the machine was.
class ReferenceProblem {
  public:
    ReferenceProblem();
    /// Mean wall clock of a solve, of 1000 in a row: work for longer than a processor is taken away at a
    /// time, so that other load shows.
    [[nodiscard]] double mean_ms();

  private:
    Scene scene_;
    std::unique_ptr<RldSolver> solver_;
};

/// Standard deviation (divisor k - 1) over mean; 0 for fewer than two values.
[[nodiscard]] double coefficient_of_variation(std::span<const double> values);

}  // namespace conelane::experiments
