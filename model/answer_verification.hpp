#pragma once

#include "conelane/lane_graph_problem.hpp"

namespace conelane {

/// The verdict on an answer. It follows from the problem alone.
struct VerifiedAnswer {
    std::string violation;   ///< the first broken constraint, in words; empty if feasible
    double objective = 0.0;  ///< (29), if feasible
};

/// Whether a set of edges is a lane graph of the problem, and its cost. The code is independent of the
/// searches and of `is_feasible`, `objective` and `paths`, which the searches use, so it finds errors in
/// them. Linear in the listed edges, turns, conflicts and forbidden pairs of ends.
[[nodiscard]] VerifiedAnswer verify_answer(const LaneGraphProblem& problem, const LaneGraph& graph);

}  // namespace conelane
