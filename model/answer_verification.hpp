#pragma once

#include "conelane/lane_graph_problem.hpp"

#include <string>

namespace conelane {

/// What an answer is worth, told from the problem alone.
struct VerifiedAnswer {
    std::string violation;   ///< the first constraint that is broken, in words; empty where it is feasible
    double objective = 0.0;  ///< (29), where it is feasible
};

/// Whether a set of edges is a lane graph of the problem, and its cost. Shares no code with the searches nor
/// with `is_feasible`, `objective` and `paths`, which they use: an error there does not pass here. Linear in
/// the edges, turns, conflicts and forbidden pairs of ends that the problem lists.
[[nodiscard]] VerifiedAnswer verify_answer(const LaneGraphProblem& problem, const LaneGraph& graph);

}  // namespace conelane
