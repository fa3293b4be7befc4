#pragma once

#include "conelane/core_solvers.hpp"
#include "conelane/lane_graph_problem.hpp"
#include "model/deadline.hpp"

#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace conelane {

/// Values in [0, 1] by problem edge, from those of the linear relaxation; nothing if the deadline passed
/// before there were any.
using Relax = std::function<std::optional<std::vector<double>>(
    const LaneGraphProblem& problem, const std::vector<double>& linear, const Deadline& deadline)>;

/// Solves the linear relaxation, improves its values by `relax` and rounds them by a search among the edges
/// that they favour. The bound is the linear relaxation's: a local minimum of a nonconvex problem is none.
/// Status feasible at best, infeasible if the linear relaxation is.
[[nodiscard]] std::unique_ptr<RldSolver> make_relaxation_solver(Relax relax);

/// Entries of relaxation_solvers, each defined beside its solver.
extern const RldSolverEntry kLpRounding;
extern const RldSolverEntry kNlopt;
extern const RldSolverEntry kIpopt;

}  // namespace conelane
