#pragma once

#include "solvers/milp/milp_solver.hpp"

#include <memory>

namespace conelane {

/// GLPK's simplex and branch and bound without cuts and presolve. GLPK is under the GPL, and so is a program
/// linked with it: CONELANE_GLPK=OFF leaves it out. Only the thread that made a session may use it. Costs of
/// very different size are handled one after the other, since GLPK's tolerances would otherwise lose the
/// optimum. The relaxation of a node cannot be stopped: a limit is overrun by up to one relaxation. An
/// internal error of GLPK ends the process.
[[nodiscard]] std::unique_ptr<MilpSolver> make_glpk_solver();

}  // namespace conelane
