#pragma once

#include "conelane/lane_graph_problem.hpp"
#include "conelane/rld_solver.hpp"
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

/// Solves the linear relaxation, improves its values by `relax` and rounds them (see round_by_search). The
/// bound is the linear relaxation's. Status feasible at best, infeasible if the linear relaxation is.
[[nodiscard]] std::unique_ptr<RldSolver> make_relaxation_solver(Relax relax);

}  // namespace conelane
