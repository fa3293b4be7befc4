#pragma once

#include "solvers/rld_solver.hpp"

#include <memory>

namespace conelane {

/// A local minimum of EdgeRelaxation by Ipopt, from the linear relaxation's solution, rounded by a search
/// among the edges that it favours. The bound is the linear relaxation's, since a local minimum of a
/// nonconvex problem bounds nothing; status feasible, or infeasible where the linear relaxation is. One solve
/// at a time in a process: Ipopt's linear solver MUMPS keeps state outside of an instance; waiting for
/// another solve is inside the time limit. Ipopt looks at the clock between its iterations only, so a limit
/// may be overrun by one of them, and by its start, some milliseconds in the first solve of a process.
[[nodiscard]] std::unique_ptr<RldSolver> make_ipopt_relaxation_solver();

}  // namespace conelane
