#pragma once

#include "conelane/core_solvers.hpp"

namespace conelane {

/// All solvers of this build: those of the core and of the components milp and relaxations.
[[nodiscard]] std::span<const RldSolverEntry> rld_solvers();

/// The entry of that name, or nullptr if there is none.
[[nodiscard]] const RldSolverEntry* find_rld_solver(std::string_view name);

}  // namespace conelane
