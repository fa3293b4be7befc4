#pragma once

#include "model/lane_graph_problem.hpp"
#include "model/rld_parameters.hpp"
#include "model/scene.hpp"
#include "solvers/rld_solver.hpp"

namespace conelane {

/// A scene, solved: the numbers that it became, and what the solver answered.
struct SolvedScene {
    LaneGraphProblem problem;  ///< empty where a limit was struck on the way to it
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
