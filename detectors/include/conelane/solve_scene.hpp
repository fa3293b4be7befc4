#pragma once

#include "conelane/lane_graph_problem.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/rld_solver.hpp"
#include "conelane/scene.hpp"

namespace conelane {

/// A solved scene: its problem and the solver's report.
struct SolvedScene {
    LaneGraphProblem problem;  ///< empty if a limit or an error ended its construction
    RldReport report;          ///< build_ms includes making the problem
    double total_ms = 0.0;     ///< from the scene in memory to the report
};

/// Makes the problem of the extent that the solver needs and solves it, both inside the time limit. If the
/// problem cannot be made in time, or would be too large, the status is stopped, with the reason. Throws only
/// std::bad_alloc: an invalid scene or invalid parameters give status error and a message.
[[nodiscard]] SolvedScene solve_scene(RldSolver& solver, const Scene& scene, const RldParameters& parameters,
                                      const SolveArguments& arguments);

}  // namespace conelane
