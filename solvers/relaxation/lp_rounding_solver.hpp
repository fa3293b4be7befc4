#pragma once

#include "conelane/rld_solver.hpp"

#include <memory>

namespace conelane {

/// Clp's relaxation of the tight formulation, rounded by a search among the edges that it favours: the
/// baseline of relaxations. The bound is the relaxation's; status feasible, or infeasible if the relaxation
/// is.
[[nodiscard]] std::unique_ptr<RldSolver> make_lp_rounding_solver();

}  // namespace conelane
