#pragma once

#include "conelane/lane_graph_problem.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/rld_solver.hpp"
#include "conelane/scene.hpp"

namespace conelane {

/// A scene, solved: the numbers that it became, and what the solver answered.
struct SolvedScene {
    LaneGraphProblem problem;  ///< empty if a limit ended its construction
    RldReport report;          ///< build_ms counts making the problem too
    double total_ms = 0.0;     ///< from the scene in memory to the report
};

/// Scene to report: makes the problem that the solver wants and solves it, both inside the time limit; where
/// the problem cannot be made within it, or would be too large, the status is stopped, with the reason.
/// Throws nothing but std::bad_alloc: a scene or parameters that are not valid give status error and a
/// message.
[[nodiscard]] SolvedScene solve_scene(RldSolver& solver, const Scene& scene, const RldParameters& parameters,
                                      const SolveLimits& limits, const LaneGraph* start = nullptr);

}  // namespace conelane
