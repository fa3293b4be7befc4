#include "evaluation/formats/program_solution.hpp"

#include "conelane/invalid_input.hpp"

#include <algorithm>
#include <cmath>
#include <istream>
#include <set>
#include <sstream>
#include <unordered_map>

#include <fmt/format.h>

namespace conelane {
namespace {

using Status = SolutionFile::Status;

/// Solvers round whole numbers and rows to about 1e-6 and may print fewer digits.
constexpr double kPointTolerance = 1e-5;

bool is_same_objective(double a, double b) {
    constexpr double kTolerance = 1e-6;
    return std::abs(a - b) <= kTolerance * std::max({1.0, std::abs(a), std::abs(b)});
}

/// The number that `text` begins with, if there is one and it is finite.
std::optional<double> find_number(const std::string& text) {
    std::istringstream words(text);
    double value = 0.0;
    if (!(words >> value) || !std::isfinite(value)) return std::nullopt;
    return value;
}

/// The lines =KEY= WORDS of a file in any format.
struct Remarks {
    std::set<std::string> keys;
    std::optional<Status> status;
    std::optional<double> objective;
    std::optional<double> bound;
    std::optional<double> engine_ms;
    std::optional<std::int64_t> nodes;
    std::string solver;
};

/// Lines of a solution file without remarks, with their numbers for messages.
class Lines {
  public:
    explicit Lines(std::istream& in) : in_(in) {}
    bool next() {
        while (!ended_) {
            ++count_;
            ended_ = !std::getline(in_, text_);
            if (ended_) break;
            if (text_.ends_with('\r')) text_.pop_back();
            if (!text_.starts_with('=')) return true;
            take_remark();
        }
        return false;
    }
    [[nodiscard]] bool is_blank() const { return text_.find_first_not_of(" \t") == std::string::npos; }
    [[nodiscard]] const std::string& text() const { return text_; }
    [[nodiscard]] const Remarks& remarks() const { return remarks_; }
    [[noreturn]] void fail(const std::string& reason) const {
        throw InvalidInput("line " + std::to_string(count_), reason);
    }

  private:
    void take_remark() {
        std::istringstream words(text_);
        std::string key;
        words >> key;
        const std::string rest = text_.substr(key.size());
        const auto value = [&] {
            const auto number = find_number(rest);
            if (!number) fail("must be " + key + " VALUE");
            return number;
        };
        if (!remarks_.keys.insert(key).second) fail(key + " is there twice");
        if (key == "=obj=") {
            remarks_.objective = value();
        } else if (key == "=infeas=") {
            remarks_.status = Status::infeasible;
        } else if (key == "=bound=") {
            remarks_.bound = value();
        } else if (key == "=ms=") {
            remarks_.engine_ms = value();
        } else if (key == "=nodes=") {
            constexpr double kMaxNodes = 1e15;
            const double count = *value();
            if (count < 0.0 || count > kMaxNodes) fail("must be =nodes= COUNT");
            remarks_.nodes = static_cast<std::int64_t>(count);
        } else if (key == "=solver=") {
            remarks_.solver = rest.substr(std::min(rest.find_first_not_of(' '), rest.size()));
        } else if (key == "=status=") {
            std::string word;
            words >> word;
            remarks_.status = word == "optimal"      ? Status::optimal
                              : word == "feasible"   ? Status::feasible
                              : word == "infeasible" ? Status::infeasible
                                                     : Status::unknown;
            if (remarks_.status == Status::unknown && word != "unknown")
                fail("=status= must be optimal, feasible, infeasible or unknown");
        } else {
            fail("is not a line of a solution: " + key);
        }
    }

    std::istream& in_;
    std::string text_;
    std::size_t count_ = 0;
    bool ended_ = false;
    Remarks remarks_;
};

/// A point that lists columns by name, without those at 0.
class NamedPoint {
  public:
    NamedPoint(const BinaryProgram& program, SolutionFile& solution)
        : program_(program), solution_(solution) {
        for (std::size_t c = 0; c < program.columns.size(); ++c) {
            column_of_.emplace(to_string(program.columns[c].label), c);
        }
        solution_.point.assign(program.columns.size(), 0.0);
        is_set_.assign(program.columns.size(), false);
    }

    void set(const std::string& name, double value, const Lines& lines) {
        const auto column = column_of_.find(name);
        if (column == column_of_.end()) lines.fail("the program has no column " + name);
        if (is_set_[column->second]) lines.fail("column " + name + " is there twice");
        if (!std::isfinite(value)) lines.fail("the value of " + name + " is not finite");
        is_set_[column->second] = true;
        solution_.point[column->second] = value;
    }

    /// A line "NAME VALUE", and whatever follows.
    void set_line(const Lines& lines) {
        std::istringstream words(lines.text());
        std::string name;
        double value = 0.0;
        if (!(words >> name >> value)) lines.fail("must be NAME VALUE");
        set(name, value, lines);
    }

    [[nodiscard]] bool is_row(const std::string& name) const {
        return !column_of_.contains(name) && std::ranges::any_of(program_.rows, [&](const auto& row) {
            return to_string(row.label) == name;
        });
    }

  private:
    const BinaryProgram& program_;
    SolutionFile& solution_;
    std::unordered_map<std::string, std::size_t> column_of_;
    std::vector<bool> is_set_;
};

/// The finite number after `key` in a line.
double number_after(std::string_view key, const Lines& lines) {
    const std::size_t at = lines.text().find(key);
    const auto number =
        at == std::string::npos ? std::nullopt : find_number(lines.text().substr(at + key.size()));
    if (!number) lines.fail("'" + std::string(key) + "' must be followed by a finite number");
    return *number;
}

/// "Optimal - objective value -4.5", or Stopped or Infeasible, then "INDEX NAME VALUE REDUCED_COST", "**"
/// before values out of bounds; rows first if they are printed too. "Optimal (within gap tolerance)" is no
/// optimum.
SolutionFile read_cbc(Lines& lines, const BinaryProgram& program) {
    SolutionFile solution;
    const std::string& head = lines.text();
    constexpr std::string_view kObjective = "objective value";
    if (head.starts_with("Optimal - ")) {
        solution.status = Status::optimal;
    } else if (head.starts_with("Optimal") || head.starts_with("Stopped")) {
        // After "Stopped on time (no integer solution - continuous used)", the values are not an incumbent.
        if (head.find("no integer solution") != std::string::npos) return solution;
        solution.status = Status::feasible;
    } else {
        solution.status = Status::infeasible;
        return solution;
    }
    solution.objective = number_after(kObjective, lines);
    NamedPoint point(program, solution);
    while (lines.next()) {
        std::istringstream words(lines.text());
        std::string index, name;
        double value = 0.0;
        if (!(words >> index)) continue;
        if (index == "**") words >> index;
        if (!(words >> name >> value)) lines.fail("must be INDEX NAME VALUE");
        if (!point.is_row(name)) point.set(name, value, lines);
    }
    return solution;
}

/// Lines by their first letter: c comment, s status, i row, j column, e end.
SolutionFile read_glpsol(Lines& lines, const BinaryProgram& program) {
    SolutionFile solution;
    bool has_status = false;
    do {
        std::istringstream words(lines.text());
        std::string kind;
        if (!(words >> kind) || kind == "c" || kind == "i") continue;
        if (kind == "e") return solution;
        if (kind == "s") {
            std::string detector, status;
            std::size_t rows = 0, columns = 0;
            double objective = 0.0;
            if (!(words >> detector >> rows >> columns >> status) || detector != "mip") {
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

/// A line for the status of the model. Below "# Primal solution values": whether there is a point,
/// "Objective VALUE" and "# Columns COUNT" with a line "NAME VALUE" for each. Rows and duals follow and are
/// skipped.
SolutionFile read_highs(Lines& lines, const BinaryProgram& program) {
    SolutionFile solution;
    if (!lines.next()) lines.fail("the file ends before the status of the model");
    const std::string status = lines.text();
    bool has_point = false;
    std::optional<NamedPoint> point;
    while (lines.next()) {
        const std::string& text = lines.text();
        if (lines.is_blank()) continue;
        if (text == "Feasible") {
            has_point = true;
        } else if (text.starts_with("Objective ")) {
            solution.objective = number_after("Objective ", lines);
        } else if (has_point && text.starts_with("# Columns")) {
            point.emplace(program, solution);
        } else if (text.starts_with("# Rows") || text.starts_with("# Dual")) {
            break;
        } else if (point) {
            point->set_line(lines);
        }
    }
    if (status == "Optimal") {
        if (!point) lines.fail("there is no point with status Optimal");
        solution.status = Status::optimal;
    } else if (status == "Infeasible") {
        solution.status = Status::infeasible;
        solution.point.clear();
    } else {
        solution.status = point ? Status::feasible : Status::unknown;
    }
    return solution;
}

/// "solution status: optimal solution found", "objective value: VALUE", then "NAME VALUE (obj:COST)"; or "no
/// solution available".
SolutionFile read_scip(Lines& lines, const BinaryProgram& program) {
    SolutionFile solution;
    const std::string status = lines.text().substr(lines.text().find(':') + 1);
    std::optional<NamedPoint> point;
    while (lines.next()) {
        const std::string& text = lines.text();
        constexpr std::string_view kObjective = "objective value:";
        if (lines.is_blank() || text.starts_with("no solution available")) continue;
        if (text.starts_with(kObjective)) {
            solution.objective = number_after(kObjective, lines);
            point.emplace(program, solution);
        } else if (point) {
            point->set_line(lines);
        } else {
            lines.fail("must be 'objective value: VALUE'");
        }
    }
    if (status.find("optimal") != std::string::npos) {
        if (!point) lines.fail("there is no point with an optimal status");
        solution.status = Status::optimal;
    } else if (status.find("infeasible") != std::string::npos && !point) {
        solution.status = Status::infeasible;
    } else {
        solution.status = point ? Status::feasible : Status::unknown;
    }
    return solution;
}

/// "NAME VALUE", and comments.
SolutionFile read_miplib(Lines& lines, const BinaryProgram& program) {
    SolutionFile solution;
    NamedPoint point(program, solution);
    bool has_point = false;
    do {
        const std::string& text = lines.text();
        if (lines.is_blank() || text.starts_with('=')) continue;  // only remarks so far
        if (!text.starts_with('#')) {
            point.set_line(lines);
            has_point = true;
            continue;
        }
        constexpr std::string_view kGurobi = "# Objective value =";
        if (text.starts_with(kGurobi)) solution.objective = number_after(kGurobi, lines);
    } while (lines.next());
    // A point at 0 may have no line except its objective.
    has_point = has_point || lines.remarks().objective || solution.objective;
    if (!has_point) solution.point.clear();
    solution.status = has_point ? Status::feasible : Status::unknown;
    return solution;
}

/// Whether a line is "NAME VALUE" with the name of a column.
bool names_a_column(const std::string& text, const BinaryProgram& program) {
    std::istringstream words(text);
    std::string name;
    double value = 0.0;
    if (!(words >> name >> value)) return false;
    return std::ranges::any_of(program.columns,
                               [&](const auto& column) { return to_string(column.label) == name; });
}

}  // namespace

SolutionFile read_solution_file(std::istream& in, const BinaryProgram& program) {
    Lines lines(in);
    bool has_line = true;
    do {
        has_line = lines.next();
    } while (has_line && lines.is_blank());
    const Remarks& remarks = lines.remarks();
    const bool has_remarks = remarks.status || remarks.objective;
    if (!has_line && !has_remarks) lines.fail("the file is empty");
    const std::string text = has_line ? lines.text() : "";
    const std::string first_word = text.substr(0, text.find(' '));
    const bool by_cbc = text.starts_with("Optimal") || text.starts_with("Stopped") ||
                        text.starts_with("Infeasible") || text.starts_with("Integer infeasible");
    bool is_miplib = false;
    SolutionFile solution;
    if (first_word == "c" || first_word == "s") {
        solution = read_glpsol(lines, program);
    } else if (text == "Model status") {
        solution = read_highs(lines, program);
    } else if (text.starts_with("solution status:")) {
        solution = read_scip(lines, program);
    } else if (by_cbc) {
        solution = read_cbc(lines, program);
    } else if (has_remarks || text.starts_with('#') || names_a_column(text, program)) {
        solution = read_miplib(lines, program);
        is_miplib = true;
    } else {
        lines.fail("is not the first line of a solution by CBC, GLPK, HiGHS or SCIP, or of a MIPLIB .sol");
    }
    while (lines.next()) {  // skips what follows the format's last line
    }
    solution.states_status = remarks.status || !is_miplib;
    if (remarks.status == Status::optimal && solution.status != Status::optimal && !is_miplib)
        lines.fail("=status= says optimal, the head of the solution does not");
    if (remarks.status) solution.status = *remarks.status;
    if (remarks.objective && solution.objective &&
        !is_same_objective(*remarks.objective, *solution.objective))
        lines.fail(fmt::format("=obj= says {:.9g}, the head of the solution {:.9g}", *remarks.objective,
                               *solution.objective));
    if (remarks.objective) solution.objective = remarks.objective;
    solution.bound = remarks.bound;
    solution.nodes = remarks.nodes;
    solution.engine_ms = remarks.engine_ms;
    solution.solver = remarks.solver;
    const bool claims_point = solution.status == Status::optimal || solution.status == Status::feasible;
    if (!claims_point) solution.point.clear();
    if (claims_point && solution.point.empty()) lines.fail("there is no point with this status");
    return solution;
}

std::string fault_of(const SolutionFile& solution, const BinaryProgram& program) {
    if (solution.point.empty()) return {};
    for (std::size_t c = 0; c < program.columns.size(); ++c) {
        const BinaryProgram::Column& column = program.columns[c];
        const double value = solution.point[c];
        if (value < column.lower - kPointTolerance || value > column.upper + kPointTolerance)
            return fmt::format("column {} is {:g}, outside {:g} to {:g}", to_string(column.label), value,
                               column.lower, column.upper);
        if (column.integer && std::abs(value - std::round(value)) > kPointTolerance)
            return fmt::format("column {} is {:g}, not integral", to_string(column.label), value);
    }
    for (std::size_t r = 0; r < program.rows.size(); ++r) {
        double sum = 0.0;
        double largest = 1.0;
        program.for_each_entry(r, [&](std::size_t column, double value) {
            const double term = value * solution.point[column];
            sum += term;
            largest = std::max(largest, std::abs(term));
        });
        const BinaryProgram::RowBounds& row = program.rows[r];
        if (sum < row.lower - kPointTolerance * largest || sum > row.upper + kPointTolerance * largest)
            return fmt::format("row {} of the program is {:g}, outside {:g} to {:g}", to_string(row.label),
                               sum, row.lower, row.upper);
    }
    double value = 0.0;
    for (std::size_t c = 0; c < program.columns.size(); ++c)
        value += program.columns[c].objective * solution.point[c];
    if (solution.objective && !is_same_objective(*solution.objective, value))
        return fmt::format("it claims the objective {:.9g}, its point has {:.9g}", *solution.objective,
                           value);
    if (solution.bound && *solution.bound > value && !is_same_objective(*solution.bound, value))
        return fmt::format("it claims the bound {:.9g}, its point has the objective {:.9g}", *solution.bound,
                           value);
    return {};
}

}  // namespace conelane
