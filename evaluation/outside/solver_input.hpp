#pragma once

#include "conelane/lane_graph_problem.hpp"
#include "model/binary_program.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

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

/// A program with rows and columns in another order. It is the same program with the same labels; a solver
/// may treat it differently.
struct PermutedProgram {
    BinaryProgram program;
    std::vector<std::size_t> column_of;  ///< the position in `program` of each column of the first program

    /// The point of the first program for a point of `program`. Empty for an empty point.
    [[nodiscard]] std::vector<double> point_of(std::span<const double> point) const;
};

/// Random orders of rows and columns; the entries of a row follow the new order of columns. The same seed
/// gives the same order on any machine.
[[nodiscard]] PermutedProgram permuted(const BinaryProgram& program, std::uint64_t seed);

}  // namespace conelane
