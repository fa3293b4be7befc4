#pragma once

#include "conelane/solver_entry.hpp"

#include <span>

namespace conelane {

/// The solvers of the core, which need no other library.
[[nodiscard]] std::span<const RldSolverEntry> core_solvers();

}  // namespace conelane
