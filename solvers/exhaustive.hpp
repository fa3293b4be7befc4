#pragma once

#include "conelane/rld_solver.hpp"

#include <memory>

namespace conelane {

/// Largest cone set that `exhaustive` takes.
inline constexpr std::size_t kExhaustiveMostCones = 9;

/// Tries every pair of disjoint simple paths: the reference for tiny problems. Larger problems give status
/// error.
[[nodiscard]] std::unique_ptr<RldSolver> make_exhaustive_solver();

}  // namespace conelane
