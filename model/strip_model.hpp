#pragma once

#include "model/binary_program.hpp"
#include "model/strip_problem.hpp"

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
    /// The first row of each family of a side.
    struct SideRows {
        std::size_t begins;   ///< by cone
        std::size_t ends;     ///< by cone
        std::size_t goes_on;  ///< by cone and place of the edge that arrives
        std::size_t comes;    ///< by cone and place of the edge that leaves
    };
    void label_rows();
    void add_lane_columns();
    void add_boundary_columns(bool is_left);
    int add_column(const Label& label, double cost, bool integer,
                   std::initializer_list<std::pair<std::size_t, double>> entries);
    [[nodiscard]] const SideRows& rows_of(bool is_left) const { return side_rows_[is_left ? 0 : 1]; }
    /// The chosen triangles along the lane, from its start.
    [[nodiscard]] std::vector<std::size_t> walk(std::span<const double> point) const;
    [[nodiscard]] std::optional<std::size_t> next(std::span<const double> point, std::size_t rung) const;
    [[nodiscard]] std::size_t start(std::span<const double> point) const;

    const StripProblem* problem_;
    BinaryProgram program_;
    std::vector<ProgramRow> rows_;
    std::size_t rung_row_ = 0;  ///< the first one; by rung
    std::size_t once_row_ = 0;  ///< by cone
    std::array<SideRows, 2> side_rows_{};
    std::vector<int> start_;     ///< column of s by rung; -1 for none
    std::vector<int> triangle_;  ///< column of y
};

}  // namespace conelane
