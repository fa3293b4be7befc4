#pragma once

#include "conelane/lane_graph_problem.hpp"

#include <string>

namespace conelane {

/// The verdict on an answer, from the problem alone.
struct VerifiedAnswer {
    std::string violation;   ///< the first constraint that is broken, in words; empty if feasible
    double objective = 0.0;  ///< (29), if feasible
};

/// Whether a set of edges is a lane graph of the problem, and its cost. Shares no code with the searches nor
/// with `is_feasible`, `objective` and `paths`, which they use, so an error there is found here. Linear in
/// the listed edges, turns, conflicts and forbidden pairs of ends.
[[nodiscard]] VerifiedAnswer verify_answer(const LaneGraphProblem& problem, const LaneGraph& graph);

}  // namespace conelane
