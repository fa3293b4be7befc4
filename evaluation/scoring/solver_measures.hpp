#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

// Measures of solvers on the same runs, as benchmarks of optimisation print them. Definitions with their
// sources: docs/measures.md.
namespace conelane {

/// One run of a solver: an instance, in one order of its rows and columns.
struct SolverRun {
    double time_ms = 0.0;  ///< wall clock
    bool solved = false;   ///< an optimum, or that there is none, was proven within the limit, and checked
};

/// The times, with `factor` times the limit for unsolved runs. Precondition: limit_ms > 0, factor >= 1.
[[nodiscard]] std::vector<double> penalised_times_ms(std::span<const SolverRun> runs, double limit_ms,
                                                     double factor = 1.0);

/// PAR k: the mean of the penalised times. Throws InvalidInput if there is no run.
[[nodiscard]] double penalised_average_ms(std::span<const SolverRun> runs, double limit_ms, double factor);

/// Dolan and Moré's performance profile of each solver: at each of the ratios, ascending and >= 1, the share
/// of the runs that it solves within this multiple of the fastest time. `by_solver` are runs of the same
/// instances in one order. A run that no solver solves counts for none. Throws InvalidInput if the numbers of
/// runs differ or there are none.
[[nodiscard]] std::vector<std::vector<double>> performance_profiles(
    std::span<const std::vector<SolverRun>> by_solver, std::span<const double> ratios);

/// The best single solver compared with the best solver of each run.
struct BestSolvers {
    std::size_t single_best = 0;  ///< the solver of the least PAR 10, the first of several
    double single_par10_ms = 0.0;
    double virtual_par10_ms =
        0.0;  ///< of the fastest that solves each run; a run that none solves is penalised
    std::vector<std::size_t> won;  ///< by solver: runs that it solves first, a tie goes to the first
};
/// Throws InvalidInput if the numbers of runs differ, or there is no solver or no run.
[[nodiscard]] BestSolvers best_solvers(std::span<const std::vector<SolverRun>> by_solver, double limit_ms);

/// Objective and bound known at some time of a run.
struct Knowledge {
    double time_ms = 0.0;
    std::optional<double> objective;  ///< of the incumbent
    std::optional<double> bound;      ///< proven lower bound
};

/// |a - b| / max(|a|, |b|), in [0, 1]; 0 if both are 0, 1 if one is absent or they differ in sign.
[[nodiscard]] double relative_distance(std::optional<double> a, std::optional<double> b);

/// Integral over [0, limit] of the gap between `known_best` and the incumbent, or the bound, as a step
/// function of time: 1 until the first of them. In milliseconds, between 0 and the limit. `steps` ascend in
/// time; those after the limit are ignored.
struct GapIntegrals {
    double primal_ms = 0.0;
    double dual_ms = 0.0;
};
[[nodiscard]] GapIntegrals gap_integrals(std::span<const Knowledge> steps, double known_best,
                                         double limit_ms);

/// Variation of the times of one instance over its permutations.
struct Variability {
    double coefficient = 0.0;  ///< standard deviation (divisor k - 1) / mean
    double ratio = 1.0;        ///< largest / smallest
};
/// Throws InvalidInput for fewer than two times. Precondition: every time is positive.
[[nodiscard]] Variability variability_of(std::span<const double> times_ms);

}  // namespace conelane
