#pragma once

#include "model/binary_program.hpp"
#include "model/strip_problem.hpp"

#include <optional>
#include <span>
#include <vector>

namespace conelane {

/// The binary program of a strip problem, which must outlive it, and the conversion of its points to lanes.
class StripModel {
  public:
    explicit StripModel(const StripProblem& problem) : problem_(&problem) {}

    /// Makes the program, or says why it stopped. Call it once.
    [[nodiscard]] std::optional<StopReason> build(const Deadline& deadline);
    [[nodiscard]] const BinaryProgram& program() const { return program_; }

    /// The lane of an integral point. Precondition: the point fulfils all rows.
    [[nodiscard]] StripLane decode(std::span<const double> point) const;
    /// Rows that circulations in an integral point violate: closed strips apart from the lane.
    [[nodiscard]] std::vector<ProgramRow> separate(std::span<const double> point) const;

  private:
    void add_columns();
    void add_rung_rows(RowWriter& rows) const;
    void add_cone_rows(RowWriter& rows) const;
    void add_edge_rows(RowWriter& rows) const;
    /// The chosen triangles along the lane, from its start.
    [[nodiscard]] std::vector<std::size_t> walk(std::span<const double> point) const;
    [[nodiscard]] std::optional<std::size_t> next(std::span<const double> point, std::size_t rung) const;
    [[nodiscard]] std::size_t start(std::span<const double> point) const;

    const StripProblem* problem_;
    BinaryProgram program_;
    // Columns; -1 for none. By side, left first: cone, place of an edge.
    std::vector<int> start_;     ///< s by rung
    std::vector<int> end_;       ///< t by rung
    std::vector<int> triangle_;  ///< y
    struct SideColumns {
        std::vector<int> turn;   ///< f as StripProblem::turn_costs of the left side
        std::vector<int> begin;  ///< b by cone and place, as StripProblem::end_costs
        std::vector<int> end;    ///< e
    };
    std::array<SideColumns, 2> sides_;
};

}  // namespace conelane
