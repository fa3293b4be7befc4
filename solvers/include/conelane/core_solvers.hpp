#pragma once

#include "conelane/solver_entry.hpp"

#include <span>

namespace conelane {

/// The solvers that need no library.
[[nodiscard]] std::span<const RldSolverEntry> core_solvers();

}  // namespace conelane
