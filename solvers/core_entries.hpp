#pragma once

#include "conelane/core_solvers.hpp"

namespace conelane {

/// Entries of core_solvers, each defined beside its solver.
extern const RldSolverEntry kPathPair;
extern const RldSolverEntry kExhaustive;

/// Largest cone set that `exhaustive` takes.
inline constexpr std::size_t kExhaustiveMostCones = 9;

/// Tries every pair of disjoint simple paths: the reference for tiny problems. Larger problems give status
/// error.
[[nodiscard]] std::unique_ptr<RldSolver> make_exhaustive_solver();

}  // namespace conelane
