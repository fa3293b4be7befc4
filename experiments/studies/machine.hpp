#pragma once

#include "conelane/rld_solver.hpp"

/// What a study measures of the machine and of this process.
namespace conelane::experiments {

/// Processor time of this thread, so that other programs do not count.
[[nodiscard]] double thread_cpu_ms();

/// Growth of this process's resident memory since construction, by the operating system (VmHWM, after
/// clear_refs). Freed memory that was not returned would hide growth, so it is returned first if the C
/// library can do so.
class PeakMemory {
  public:
    PeakMemory();
    /// In bytes; absent if the system does not report it.
    [[nodiscard]] std::optional<std::size_t> rise_bytes() const;

  private:
    std::optional<std::size_t> before_bytes_;
};

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
