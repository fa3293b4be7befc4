#pragma once

#include "conelane/lane_graph_problem.hpp"
#include "model/binary_program.hpp"

namespace conelane {

/// Completes the program of a problem by the columns and rows of a flow. They replace the rows that are
/// otherwise added on demand: no cycles (5) and the pairing, which are too many to write in full.
///
/// Each cone of degree A_i takes A_i / 2 of a flow that runs along chosen edges (y_i_j, from cone i to cone
/// j) and comes from the ends of paths (s_i); with the pairing near_far only from near ends. A cycle has no
/// end but takes flow, and so does a path between two far ends: both are infeasible. There are two columns
/// for each edge and one for each possible source, all continuous, so the program's integer points are the
/// lane graphs with their costs. Precondition: `program` was built from the problem, in either formulation
/// (columns a_i_j).
void add_connecting_flow(BinaryProgram& program, const LaneGraphProblem& problem);

}  // namespace conelane
