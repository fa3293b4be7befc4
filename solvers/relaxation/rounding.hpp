#pragma once

#include "conelane/lane_graph_problem.hpp"
#include "conelane/rld_solver.hpp"

#include <span>

namespace conelane {

/// The cheapest lane graph among the edges that a relaxation favours: those with a value of at least 1/2; if
/// they hold no lane graph, at least 1/5, 1/20, 1/100 and 1/1000. path-pair searches each set completely. The
/// report is feasible, with objective and lane graph, or stopped; it has no bound.
[[nodiscard]] RldReport round_by_search(const LaneGraphProblem& problem, std::span<const double> edge_values,
                                        RldSolver& path_pair, const SolveLimits& limits);

}  // namespace conelane
