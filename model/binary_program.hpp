#pragma once

#include "conelane/stop_reason.hpp"
#include "model/deadline.hpp"

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace conelane {

/// Name of a column or row: a symbol or family with up to three indices, written "f_3_1_7". `family` must
/// outlive the program: it is a string literal.
struct Label {
    struct Index {
        std::int32_t first = -1;  ///< -1 if absent
        std::int32_t second = -1;
        std::int32_t third = -1;
    };
    std::string_view family;
    Index index{};
};
[[nodiscard]] std::string to_string(const Label& label);

/// A linear row: lower <= sum of coefficient * column <= upper, each column at most once.
struct ProgramRow {
    Label label;
    std::vector<std::pair<int, double>> terms;
    double lower;
    double upper;
};

/// A linear program with some columns binary, as plain data: minimise objective * x, rows within their
/// bounds, columns within theirs. Rows are stored one after the other (compressed sparse rows).
struct BinaryProgram {
    struct Column {
        Label label;
        double objective;
        double lower;
        double upper;
        bool integer;
        bool branch_first = false;  ///< hint: among the integer columns, branch on these first
    };
    struct RowBounds {
        Label label;
        double lower;
        double upper;
    };

    std::vector<Column> columns;
    std::vector<RowBounds> rows;
    std::vector<int> row_starts{0};  ///< rows.size() + 1 positions in `entry_columns` and `entry_values`
    std::vector<int> entry_columns;
    std::vector<double> entry_values;

    int add_column(const Label& label, double objective, bool integer, double lower = 0.0,
                   double upper = 1.0);
    /// Removes this row and all later ones.
    void truncate_rows(std::size_t first);
    /// Calls `use(column, value)` for each entry of a row, in their order.
    template <typename Use>
    void for_each_entry(std::size_t row, const Use& use) const {
        const auto end = static_cast<std::size_t>(row_starts[row + 1]);
        for (auto entry = static_cast<std::size_t>(row_starts[row]); entry < end; ++entry)
            use(static_cast<std::size_t>(entry_columns[entry]), entry_values[entry]);
    }
};

/// Largest number of columns and entries together of a program built within limits, below 300 MB; a solver
/// that loads it takes several times as much.
inline constexpr std::size_t kMaxProgramEntries = 4'000'000;

/// Writes rows into a program. Terms of the same column are added up.
class RowWriter {
  public:
    /// With a deadline, `stop` tells whether it has passed or the program has reached its largest size.
    explicit RowWriter(BinaryProgram& program, const Deadline* deadline = nullptr);

    /// Whether to stop. A caller that writes many rows checks this between them. Rows written after it is
    /// true are ignored.
    [[nodiscard]] bool stop();
    [[nodiscard]] std::optional<StopReason> stopped_by() const { return stopped_by_; }

    void begin(const Label& label, double lower, double upper);
    void add(int column, double coefficient);
    void end();
    /// A whole row of few terms.
    void write(const Label& label, double lower, double upper,
               std::initializer_list<std::pair<int, double>> terms) {
        begin(label, lower, upper);
        for (const auto& [column, coefficient] : terms) add(column, coefficient);
        end();
    }

  private:
    BinaryProgram& program_;
    const Deadline* deadline_;
    int until_clock_ = 0;
    std::optional<StopReason> stopped_by_;
    std::vector<int> position_;  ///< position of a column in the open row, -1 if absent
};

inline constexpr double kInfinity = 1e300;  ///< the bound of a row without a limit

}  // namespace conelane
