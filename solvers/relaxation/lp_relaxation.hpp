#pragma once

#include "conelane/lane_graph_problem.hpp"
#include "model/deadline.hpp"

#include <optional>
#include <vector>

namespace conelane {

/// The linear relaxation of the tight formulation without its lazy rows.
struct LpRelaxation {
    bool infeasible = false;      ///< proven: the problem has no lane graph
    std::optional<double> bound;  ///< its optimum, a lower bound of the problem; absent if stopped
    std::optional<StopReason> stopped_by;
    std::vector<double> edge_values;  ///< a_ij by problem edge, with the bound
};
/// Solved by Clp; throws std::runtime_error if that fails. Precondition: the problem lists only the
/// candidates.
[[nodiscard]] LpRelaxation solve_lp_relaxation(const LaneGraphProblem& problem, const Deadline& deadline);

}  // namespace conelane
