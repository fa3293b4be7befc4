#pragma once

#include "solvers/milp/milp_solver.hpp"

#include <memory>

namespace conelane {

/// CBC's full default machinery (CbcMain1: preprocessing, cuts, heuristics, strong branching), faster than
/// `cbc` on the paper formulation. The feasibility pump is off: it aborts on some programs. Each solve is in
/// a copy of the process (detail::in_own_process), one at a time; the time limit includes waiting for another
/// solve. The clock is checked in every relaxation and at every node, but not within preprocessing and cut
/// generation: one of these steps may overrun the limit.
[[nodiscard]] std::unique_ptr<MilpSolver> make_cbc_main_solver();

}  // namespace conelane
