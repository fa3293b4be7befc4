#pragma once

#include "solvers/milp/milp_solver.hpp"

#include <memory>

namespace conelane {

/// GLPK's simplex and branch and bound without cuts and presolve. GLPK is under the GPL, which a program
/// linked with it falls under too: CONELANE_GLPK leaves it out. A session is used by the thread that made it.
/// Costs of very different size are taken in turn, since GLPK's tolerances would lose the optimum beside
/// them. The relaxation of a node cannot be stopped: a limit is overrun by up to one of them. An internal
/// error of GLPK ends the process.
[[nodiscard]] std::unique_ptr<MilpSolver> make_glpk_solver();

}  // namespace conelane
