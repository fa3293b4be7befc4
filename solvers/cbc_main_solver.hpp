#pragma once

#include "solvers/milp_solver.hpp"

#include <memory>

namespace conelane {

/// CBC's full default machinery (CbcMain1: preprocessing, cuts, heuristics, strong branching), faster than
/// `cbc` on the paper formulation. One solve at a time in a process, since several of them in threads fail in
/// CBC 2.10.8; waiting for one's turn is inside the time limit. CBC looks at the clock between its phases and
/// nodes only, so a limit may be overrun by one of them; a claim of infeasibility in the second half of a
/// limit is reported as time_limit.
[[nodiscard]] std::unique_ptr<MilpSolver> make_cbc_main_solver();

}  // namespace conelane
