#pragma once

#include "model/binary_program.hpp"
#include "model/formulation.hpp"
#include "model/lane_graph.hpp"
#include "model/lane_graph_problem.hpp"

#include <span>
#include <vector>

namespace conelane {

/// The binary program of a lane-graph problem, and the way back from its points to lane graphs. Sole owner of
/// the column map. Refers to the problem of its making or last update, which must outlive its use.
class LaneGraphModel {
  public:
    /// Precondition: the problem was made with the extent that the formulation needs.
    LaneGraphModel(const LaneGraphProblem& problem, Formulation formulation);

    /// Makes this the program of another problem, the same as built anew. With as many cones as before, the
    /// paper formulation keeps its columns and the rows that depend on their number alone (most of them), and
    /// writes costs and the other rows; the columns of the tight formulation depend on the scene, so only its
    /// memory is kept. Precondition as for the constructor.
    void update(const LaneGraphProblem& problem);

    [[nodiscard]] const BinaryProgram& program() const { return program_; }

    /// The edges chosen by a point of the program (a_ij > 1/2).
    [[nodiscard]] LaneGraph decode(std::span<const double> point) const;

    /// Rows of (5), and of the pairing near_far, that an integral point violates; empty where it is a lane
    /// graph. Every candidate must pass this before it counts as a solution.
    [[nodiscard]] std::vector<ProgramRow> separate(std::span<const double> point) const;

  private:
    [[nodiscard]] std::vector<bool> chosen_edges(std::span<const double> point) const;

    void build();
    void add_columns();
    void refresh_costs();
    void write_rows(std::span<const ConstraintFamily> families);

    const LaneGraphProblem* problem_;
    std::size_t problem_cones_ = 0;  ///< of the problem that the columns were made for
    Formulation formulation_;
    ColumnMap columns_;
    BinaryProgram program_;
    std::size_t fixed_rows_ = 0;
};

}  // namespace conelane
