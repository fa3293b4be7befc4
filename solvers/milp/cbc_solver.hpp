#pragma once

#include "solvers/milp/milp_solver.hpp"

#include <memory>

namespace conelane {

/// CBC in process: first the relaxation by Clp, which is the answer if it is integral; else CbcModel's branch
/// and bound without cuts, preprocessing, heuristics and strong branching, which is fastest on the tight
/// formulation. The clock is checked in every iteration of Clp. Loading a program, and Clp's presolve and
/// postsolve of the first relaxation, cannot be stopped: they overrun a limit by up to 1 ms with 24 cones, 15
/// ms with 200. `clp-bb` has no such part.
[[nodiscard]] std::unique_ptr<MilpSolver> make_cbc_solver();

}  // namespace conelane
