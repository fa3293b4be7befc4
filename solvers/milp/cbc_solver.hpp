#pragma once

#include "solvers/milp/milp_solver.hpp"

#include <memory>

namespace conelane {

/// CBC in process: the relaxation by Clp first, done where it is integral; else CbcModel's branch and bound
/// without cuts, preprocessing, heuristics and strong branching, which is fastest on the tight formulation.
/// The clock is looked at in every iteration of Clp. Loading a program and Clp's presolve and postsolve of
/// the first relaxation cannot be stopped: a limit is overrun by up to their time, 1 ms with 24 cones, 15 ms
/// with 200. `clp-bb` has no such part.
[[nodiscard]] std::unique_ptr<MilpSolver> make_cbc_solver();

}  // namespace conelane
