#pragma once

#include "model/binary_program.hpp"
#include "model/formulation.hpp"
#include "model/lane_graph.hpp"
#include "model/lane_graph_problem.hpp"

#include <span>
#include <vector>

namespace conelane {

/// The binary program of a lane-graph problem, and the way back from its points to lane graphs. Sole owner of
/// the column map. Refers to the problem, which must outlive it.
class LaneGraphModel {
  public:
    /// Precondition: the problem was made with the extent that the formulation needs.
    LaneGraphModel(const LaneGraphProblem& problem, Formulation formulation);

    [[nodiscard]] const BinaryProgram& program() const { return program_; }

    /// The edges chosen by a point of the program (a_ij > 1/2).
    [[nodiscard]] LaneGraph decode(std::span<const double> point) const;

    /// Rows of (5), and of the pairing near_far, that an integral point violates; empty where it is a lane
    /// graph. Every candidate must pass this before it counts as a solution.
    [[nodiscard]] std::vector<ProgramRow> separate(std::span<const double> point) const;

  private:
    [[nodiscard]] std::vector<bool> chosen_edges(std::span<const double> point) const;

    const LaneGraphProblem& problem_;
    ColumnMap columns_;
    BinaryProgram program_;
};

}  // namespace conelane
