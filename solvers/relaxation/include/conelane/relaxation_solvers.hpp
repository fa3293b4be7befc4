#pragma once

#include "conelane/core_solvers.hpp"

#include <span>

namespace conelane {

/// The solvers of the component relaxations: a relaxation, rounded.
[[nodiscard]] std::span<const RldSolverEntry> relaxation_solvers();

}  // namespace conelane
