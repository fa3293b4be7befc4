#include "evaluation/formats/program_files.hpp"

#include "conelane/invalid_input.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <ostream>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

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
            throw InvalidInput(key, "two have the name " + names.back());
        }
    }
    return names;
}

struct Names {
    explicit Names(const BinaryProgram& program)
        : columns(unique_names(program.columns, "columns")), rows(unique_names(program.rows, "rows")) {
        if (columns.empty()) throw InvalidInput("columns", "a file needs at least one");
    }
    std::vector<std::string> columns;
    std::vector<std::string> rows;
};

char mps_sense(const BinaryProgram::RowBounds& row) {
    if (row.lower == row.upper) return 'E';
    if (is_finite_upper(row.upper)) return 'L';
    return is_finite_lower(row.lower) ? 'G' : 'N';
}

/// MPS lists the matrix by columns: (row, value) for each.
std::vector<std::vector<std::pair<std::size_t, double>>> entries_by_column(const BinaryProgram& program) {
    std::vector<std::vector<std::pair<std::size_t, double>>> entries(program.columns.size());
    for (std::size_t r = 0; r < program.rows.size(); ++r) {
        program.for_each_entry(
            r, [&](std::size_t column, double value) { entries[column].emplace_back(r, value); });
    }
    return entries;
}

/// Terms of one LP row, a few in each line: some readers limit the length of a line.
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
        program.for_each_entry(
            r, [&](std::size_t column, double value) { terms.add(value, names.columns[column]); });
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
            throw InvalidInput(names.columns[c], "is an integer column, but not between 0 and 1");
        }
    }
    out << "Binaries\n";
    for (std::size_t c = 0; c < program.columns.size(); ++c) {
        if (program.columns[c].integer) out << ' ' << names.columns[c] << '\n';
    }
    out << "End\n";
}

}  // namespace conelane
