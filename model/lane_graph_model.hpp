#pragma once

#include "model/formulation_parts.hpp"

namespace conelane {

/// The binary program of a lane-graph problem, and the conversion of its points to lane graphs. It alone
/// knows the columns of the variables. It refers to the problem of its construction or last update, which
/// must outlive its use.
class LaneGraphModel {
  public:
    /// Without a problem.
    explicit LaneGraphModel(Formulation formulation) : formulation_(formulation) {}
    /// Precondition: the problem was made with the extent that the formulation needs.
    LaneGraphModel(const LaneGraphProblem& problem, Formulation formulation);

    /// Makes this the program of another problem, equal to a new one. If the number of cones is the same, the
    /// paper formulation keeps its columns and the rows that depend only on that number (most of them), and
    /// writes costs and the other rows. The columns of the tight formulation depend on the scene, so only its
    /// memory is kept. Precondition as for the constructor.
    void update(const LaneGraphProblem& problem);

    /// As above, or why construction stopped: if the deadline passes, or problem or program are too large
    /// (see is_too_large and kMaxProgramEntries), there is no program until the next update.
    [[nodiscard]] std::optional<StopReason> update(const LaneGraphProblem& problem, const Deadline& deadline);

    [[nodiscard]] const BinaryProgram& program() const { return program_; }

    /// The edges chosen by a point of the program (a_ij > 1/2).
    [[nodiscard]] LaneGraph decode(std::span<const double> point) const;

    /// Rows of (5), and of the pairing near_far, that an integral point violates; empty for a lane graph.
    /// Every candidate must pass this check before it counts as a solution.
    [[nodiscard]] std::vector<ProgramRow> separate(std::span<const double> point) const;

  private:
    [[nodiscard]] std::vector<bool> chosen_edges(std::span<const double> point) const;

    std::optional<StopReason> update(const LaneGraphProblem& problem, const Deadline* deadline);
    std::optional<StopReason> build(const Deadline* deadline);
    void add_columns();
    void refresh_costs();
    std::optional<StopReason> write_rows(std::span<const ConstraintFamily> families,
                                         const Deadline* deadline);

    const LaneGraphProblem* problem_ = nullptr;
    /// The number of cones that the columns and the fixed rows were made for; absent without a program.
    std::optional<std::size_t> problem_cones_;
    Formulation formulation_;
    ColumnMap columns_;
    BinaryProgram program_;
    std::size_t fixed_rows_ = 0;
};

}  // namespace conelane
