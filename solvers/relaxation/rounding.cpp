#include "solvers/relaxation/rounding.hpp"

#include "model/deadline.hpp"

#include <array>
#include <utility>

namespace conelane {
namespace {

constexpr std::array<double, 5> kFavoured{0.5, 0.2, 0.05, 0.01, 0.001};

}  // namespace

RldReport round_by_search(const LaneGraphProblem& problem, std::span<const double> edge_values,
                          RldSolver& path_pair, const SolveLimits& limits) {
    const Deadline deadline(limits.time_limit_ms);
    RldReport rounded;
    rounded.status = SolveStatus::stopped;
    for (const double least : kFavoured) {
        if (deadline.passed()) {
            rounded.stopped_by = StopReason::time;
            return rounded;
        }
        LaneGraphProblem favoured = problem;
        for (std::size_t e = 0; e < problem.edges.size(); ++e) {
            if (edge_values[e] < least) favoured.edges[e].high_cost = true;
        }
        const RldReport found = path_pair.solve(favoured, {deadline.remaining_ms(), limits.absolute_gap});
        rounded.nodes += found.nodes;
        if (!found.lane_graph) continue;
        rounded.status = SolveStatus::feasible;
        rounded.lane_graph = found.lane_graph;
        rounded.objective = found.objective;
        return rounded;
    }
    rounded.status = SolveStatus::error;
    rounded.message = "the edges that the relaxation favours hold no lane graph";
    return rounded;
}

}  // namespace conelane
