#pragma once

#include "conelane/rld_solver.hpp"

#include <memory>

namespace conelane {

/// A local minimum of EdgeRelaxation by Ipopt, from the linear relaxation's solution, rounded by a search
/// among the edges that it favours. The bound is the linear relaxation's, because a local minimum of a
/// nonconvex problem is not a bound; status feasible, or infeasible if the linear relaxation is. One solve at
/// a time in a process: Ipopt's linear solver MUMPS keeps global state; the time limit includes waiting for
/// another solve. Ipopt checks the clock only between its iterations, so one iteration may overrun a limit,
/// and so may its start-up, some milliseconds in the first solve of a process.
[[nodiscard]] std::unique_ptr<RldSolver> make_ipopt_relaxation_solver();

}  // namespace conelane
