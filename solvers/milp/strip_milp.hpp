#pragma once

#include "solvers/milp/milp_solver.hpp"
#include "solvers/strip/strip_solver.hpp"

namespace conelane {

/// Solves a strip problem by a MILP backend: build the program, solve it, forbid the circulations of its
/// answer, and solve again until there are none. The time limit includes building the program.
[[nodiscard]] StripReport solve_strip_by_milp(const MilpBackend& backend, const StripProblem& problem,
                                              const SolveLimits& limits);

}  // namespace conelane
