#pragma once

#include "solvers/milp/milp_solver.hpp"

#include <memory>

namespace conelane {

/// Depth-first branch and bound on a warm Clp relaxation: branches on the most fractional column, the nearer
/// side first. No cuts, no heuristics; made for the tight formulation.
[[nodiscard]] std::unique_ptr<MilpSolver> make_clp_bb_solver();

}  // namespace conelane
