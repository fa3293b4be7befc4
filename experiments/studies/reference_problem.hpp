#pragma once

#include "conelane/rld_solver.hpp"
#include "conelane/scene.hpp"

#include <memory>
#include <span>

namespace conelane::experiments {

/// One scene of a generated course, solved by path-pair repeatedly: the same work for any study. Run between
/// the blocks of a study, it shows how steady the machine was.
class ReferenceProblem {
  public:
    ReferenceProblem();
    /// Mean wall clock of 1000 solves in a row: longer than a time slice, so that other load shows.
    [[nodiscard]] double mean_ms();

  private:
    Scene scene_;
    std::unique_ptr<RldSolver> solver_;
};

/// Standard deviation (divisor k - 1) over mean; 0 for fewer than two values.
[[nodiscard]] double coefficient_of_variation(std::span<const double> values);

}  // namespace conelane::experiments
