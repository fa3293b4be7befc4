#pragma once

#include "conelane/core_solvers.hpp"

#include <span>

namespace conelane {

/// The solvers of the component milp: the model as a binary program, solved by branch and bound.
[[nodiscard]] std::span<const RldSolverEntry> milp_solvers();

}  // namespace conelane
