#include "evaluation/files/program_files.hpp"

#include "conelane/invalid_input.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <istream>
#include <ostream>
#include <sstream>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace conelane {
namespace {

std::string number(double value) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
    return {text.data(), end.ptr};
}

bool is_finite_lower(double bound) {
    return bound > -kInfinity;
}
bool is_finite_upper(double bound) {
    return bound < kInfinity;
}
bool is_range(const BinaryProgram::RowBounds& row) {
    return is_finite_lower(row.lower) && is_finite_upper(row.upper) && row.lower != row.upper;
}

template <typename Named>
std::vector<std::string> unique_names(const std::vector<Named>& all, const std::string& key) {
    std::vector<std::string> names;
    std::unordered_set<std::string> seen;
    for (const Named& named : all) {
        names.push_back(to_string(named.label));
        if (!seen.insert(names.back()).second) {
            throw InvalidInput(key, "two of the name " + names.back());
        }
    }
    return names;
}

struct Names {
    explicit Names(const BinaryProgram& program)
        : columns(unique_names(program.columns, "columns")), rows(unique_names(program.rows, "rows")) {
        if (columns.empty()) throw InvalidInput("columns", "a file needs one at least");
    }
    std::vector<std::string> columns;
    std::vector<std::string> rows;
};

char mps_sense(const BinaryProgram::RowBounds& row) {
    if (row.lower == row.upper) return 'E';
    if (is_finite_upper(row.upper)) return 'L';
    return is_finite_lower(row.lower) ? 'G' : 'N';
}

/// MPS wants the matrix by columns: (row, value) for each.
std::vector<std::vector<std::pair<std::size_t, double>>> entries_by_column(const BinaryProgram& program) {
    std::vector<std::vector<std::pair<std::size_t, double>>> entries(program.columns.size());
    for (std::size_t r = 0; r < program.rows.size(); ++r) {
        for (auto e = static_cast<std::size_t>(program.row_starts[r]);
             e < static_cast<std::size_t>(program.row_starts[r + 1]); ++e) {
            entries[static_cast<std::size_t>(program.entry_columns[e])].emplace_back(r,
                                                                                     program.entry_values[e]);
        }
    }
    return entries;
}

}  // namespace

void write_mps(std::ostream& out, const BinaryProgram& program, std::string_view name) {
    const Names names(program);
    out << "NAME " << name << " FREE\nROWS\n N cost\n";
    for (std::size_t r = 0; r < program.rows.size(); ++r) {
        out << ' ' << mps_sense(program.rows[r]) << ' ' << names.rows[r] << '\n';
    }
    out << "COLUMNS\n";
    const auto entries = entries_by_column(program);
    bool inside_integers = false;
    const auto mark = [&](bool integer) {
        if (integer == inside_integers) return;
        inside_integers = integer;
        out << " MARKER 'MARKER' " << (integer ? "'INTORG'" : "'INTEND'") << '\n';
    };
    for (std::size_t c = 0; c < program.columns.size(); ++c) {
        mark(program.columns[c].integer);
        out << ' ' << names.columns[c] << " cost " << number(program.columns[c].objective) << '\n';
        for (const auto& [row, value] : entries[c]) {
            out << ' ' << names.columns[c] << ' ' << names.rows[row] << ' ' << number(value) << '\n';
        }
    }
    mark(false);
    out << "RHS\n";
    for (std::size_t r = 0; r < program.rows.size(); ++r) {
        const BinaryProgram::RowBounds& row = program.rows[r];
        const double side = is_finite_upper(row.upper) ? row.upper : row.lower;
        if (side != 0.0 && is_finite_lower(side))
            out << " rhs " << names.rows[r] << ' ' << number(side) << '\n';
    }
    out << "RANGES\n";
    for (std::size_t r = 0; r < program.rows.size(); ++r) {
        const BinaryProgram::RowBounds& row = program.rows[r];
        if (is_range(row)) out << " range " << names.rows[r] << ' ' << number(row.upper - row.lower) << '\n';
    }
    out << "BOUNDS\n";
    for (std::size_t c = 0; c < program.columns.size(); ++c) {
        const BinaryProgram::Column& column = program.columns[c];
        out << " LO bound " << names.columns[c] << ' ' << number(column.lower) << '\n';
        out << " UP bound " << names.columns[c] << ' ' << number(column.upper) << '\n';
    }
    out << "ENDATA\n";
}

namespace {

/// Terms of one LP row, a line each few of them: some readers limit the length of a line.
class LpTerms {
  public:
    explicit LpTerms(std::ostream& out) : out_(out) {}
    void add(double coefficient, const std::string& column) {
        if (count_ > 0 && count_ % kTermsInALine == 0) out_ << "\n  ";
        ++count_;
        out_ << (coefficient < 0.0 ? " - " : " + ") << number(std::abs(coefficient)) << ' ' << column;
    }
    [[nodiscard]] bool empty() const { return count_ == 0; }

  private:
    static constexpr int kTermsInALine = 8;
    std::ostream& out_;
    int count_ = 0;
};

}  // namespace

void write_lp(std::ostream& out, const BinaryProgram& program, std::string_view name) {
    const Names names(program);
    out << "\\ " << name << "\nMinimize\n cost:";
    LpTerms objective(out);
    for (std::size_t c = 0; c < program.columns.size(); ++c) {
        objective.add(program.columns[c].objective, names.columns[c]);
    }
    out << "\nSubject To\n";
    const auto write_row = [&](std::size_t r, const std::string& suffix, std::string_view sense,
                               double side) {
        out << ' ' << names.rows[r] << suffix << ':';
        LpTerms terms(out);
        for (auto e = static_cast<std::size_t>(program.row_starts[r]);
             e < static_cast<std::size_t>(program.row_starts[r + 1]); ++e) {
            terms.add(program.entry_values[e],
                      names.columns[static_cast<std::size_t>(program.entry_columns[e])]);
        }
        if (terms.empty()) terms.add(0.0, names.columns.front());
        out << ' ' << sense << ' ' << number(side) << '\n';
    };
    for (std::size_t r = 0; r < program.rows.size(); ++r) {
        const BinaryProgram::RowBounds& row = program.rows[r];
        if (is_range(row)) {
            write_row(r, "_low", ">=", row.lower);
            write_row(r, "_high", "<=", row.upper);
        } else if (row.lower == row.upper) {
            write_row(r, "", "=", row.upper);
        } else if (is_finite_upper(row.upper)) {
            write_row(r, "", "<=", row.upper);
        } else if (is_finite_lower(row.lower)) {
            write_row(r, "", ">=", row.lower);
        }
    }
    out << "Bounds\n";
    for (std::size_t c = 0; c < program.columns.size(); ++c) {
        const BinaryProgram::Column& column = program.columns[c];
        if (!column.integer) {
            out << ' ' << number(column.lower) << " <= " << names.columns[c] << " <= " << number(column.upper)
                << '\n';
        } else if (column.lower != 0.0 || column.upper != 1.0) {
            throw InvalidInput(names.columns[c], "is integer, yet not between 0 and 1");
        }
    }
    out << "Binaries\n";
    for (std::size_t c = 0; c < program.columns.size(); ++c) {
        if (program.columns[c].integer) out << ' ' << names.columns[c] << '\n';
    }
    out << "End\n";
}

namespace {

/// Lines of a solution file, for messages that name them.
class Lines {
  public:
    explicit Lines(std::istream& in) : in_(in) {}
    bool next() {
        ++count_;
        return static_cast<bool>(std::getline(in_, text_));
    }
    [[nodiscard]] const std::string& text() const { return text_; }
    [[noreturn]] void fail(const std::string& reason) const {
        throw InvalidInput("line " + std::to_string(count_), reason);
    }

  private:
    std::istream& in_;
    std::string text_;
    std::size_t count_ = 0;
};

/// "Optimal - objective value -4.5", then "INDEX NAME VALUE REDUCED_COST", "**" before values out of bounds.
SolutionFile read_cbc(Lines& lines, const BinaryProgram& program) {
    using Status = SolutionFile::Status;
    SolutionFile solution;
    const std::string& head = lines.text();
    if (head.starts_with("Optimal")) {
        solution.status = Status::optimal;
    } else if (head.starts_with("Infeasible") || head.starts_with("Integer infeasible")) {
        solution.status = Status::infeasible;
        return solution;
    } else if (head.starts_with("Stopped")) {
        solution.status = Status::feasible;
    } else {
        lines.fail("is no first line of a solution by cbc or by glpsol --write");
    }
    constexpr std::string_view kObjective = "objective value";
    const std::size_t place = head.find(kObjective);
    if (place != std::string::npos) {
        std::istringstream words(head.substr(place + kObjective.size()));
        double value = 0.0;
        if (words >> value) solution.objective = value;
    }
    std::unordered_map<std::string, std::size_t> column_of;
    for (std::size_t c = 0; c < program.columns.size(); ++c) {
        column_of.emplace(to_string(program.columns[c].label), c);
    }
    solution.point.assign(program.columns.size(), 0.0);
    while (lines.next()) {
        std::istringstream words(lines.text());
        std::string index, name;
        double value = 0.0;
        if (!(words >> index)) continue;
        if (index == "**") words >> index;
        if (!(words >> name >> value)) lines.fail("must be INDEX NAME VALUE");
        const auto column = column_of.find(name);
        if (column == column_of.end()) lines.fail("the program has no column " + name);
        solution.point[column->second] = value;
    }
    return solution;
}

/// Lines by their first letter: c comment, s status, i row, j column, e end.
SolutionFile read_glpsol(Lines& lines, const BinaryProgram& program) {
    using Status = SolutionFile::Status;
    SolutionFile solution;
    bool has_status = false;
    do {
        std::istringstream words(lines.text());
        std::string kind;
        if (!(words >> kind) || kind == "c" || kind == "i") continue;
        if (kind == "e") return solution;
        if (kind == "s") {
            std::string method, status;
            std::size_t rows = 0, columns = 0;
            double objective = 0.0;
            if (!(words >> method >> rows >> columns >> status) || method != "mip") {
                lines.fail("must be 's mip ROWS COLUMNS STATUS OBJECTIVE'");
            }
            if (columns != program.columns.size()) {
                lines.fail("has " + std::to_string(columns) + " columns, the program " +
                           std::to_string(program.columns.size()));
            }
            has_status = true;
            solution.status = status == "o"   ? Status::optimal
                              : status == "f" ? Status::feasible
                              : status == "n" ? Status::infeasible
                                              : Status::unknown;
            if (solution.status != Status::optimal && solution.status != Status::feasible) continue;
            if (words >> objective) solution.objective = objective;
            solution.point.assign(columns, 0.0);
        } else if (kind == "j") {
            std::size_t column = 0;
            double value = 0.0;
            if (!has_status || !(words >> column >> value) || column < 1 || column > program.columns.size()) {
                lines.fail("must be 'j COLUMN VALUE' after the line of the status");
            }
            if (!solution.point.empty()) solution.point[column - 1] = value;
        } else {
            lines.fail("begins with none of c, s, i, j and e");
        }
    } while (lines.next());
    lines.fail("the file ends before its line 'e o f'");
}

}  // namespace

SolutionFile read_solution_file(std::istream& in, const BinaryProgram& program) {
    Lines lines(in);
    if (!lines.next()) lines.fail("the file is empty");
    const std::string first_word = lines.text().substr(0, lines.text().find(' '));
    const bool by_glpsol = first_word == "c" || first_word == "s";
    return by_glpsol ? read_glpsol(lines, program) : read_cbc(lines, program);
}

}  // namespace conelane
