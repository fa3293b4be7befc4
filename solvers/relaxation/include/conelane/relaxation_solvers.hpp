#pragma once

#include "conelane/solver_entry.hpp"

#include <span>

namespace conelane {

/// The solvers of the component relaxations: a relaxation, rounded.
[[nodiscard]] std::span<const RldSolverEntry> relaxation_solvers();

}  // namespace conelane
