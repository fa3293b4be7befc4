#pragma once

#include "conelane/lane_graph_problem.hpp"
#include "model/binary_program.hpp"

namespace conelane {

/// Makes the program of a problem whole: adds columns and rows of a flow that stand for the rows that are
/// otherwise added on demand, no cycles (5) and the pairing, of which there are too many to write them out.
///
/// Each cone of degree A_i takes A_i / 2 of a flow that runs along chosen edges only (y_i_j, from cone i to
/// cone j) and comes from the ends of paths (s_i), under the pairing near_far from near ones alone. A cycle
/// has no end and takes, and so does a path between two far ends: neither can be fed. Two per edge and one
/// per possible source, all continuous, so the program's integer points are the lane graphs, each with its
/// cost. Precondition: `program` was built from the problem, in either formulation (columns a_i_j).
void add_connecting_flow(BinaryProgram& program, const LaneGraphProblem& problem);

}  // namespace conelane
