#pragma once

#include "solvers/milp/milp_solver.hpp"

#include <memory>

namespace conelane {

/// CBC in process: the relaxation by Clp first, done where it is integral; else CbcModel's branch and bound
/// without cuts, preprocessing, heuristics and strong branching, which is fastest on the tight formulation.
[[nodiscard]] std::unique_ptr<MilpSolver> make_cbc_solver();

}  // namespace conelane
