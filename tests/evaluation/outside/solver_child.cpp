// A solver from outside for the tests, which reads MPS files and solves them by CBC:
//
//     solver_child [FAULT K MARKER]                    a conversation
//     solver_child once PROGRAM SOLUTION [FAULT MARKER]
//
// At the K-th program it commits the fault, but only if the file MARKER does not exist, which it then
// creates. The marker "always" never exists. It writes its input to the file named by SOLVER_LOG.

#include "solvers/milp/milp_solver.hpp"
#include "tests/evaluation/outside/process_faults.hpp"

#include <filesystem>
#include <fstream>
#include <list>
#include <map>
#include <sstream>

#include <nlohmann/json.hpp>

namespace {

using conelane::BinaryProgram;
using conelane::MilpReport;
using conelane::SolveStatus;
using conelane::tests::commit_process_fault;

struct NamedProgram {
    BinaryProgram program;
    std::vector<std::string> columns;
};

/// Reads free MPS as conelane writes it.
NamedProgram read_mps(const std::string& file) {
    NamedProgram read;
    std::ifstream in(file);
    std::string section;
    std::map<std::string, int> rows, columns;
    std::vector<char> senses;
    std::vector<double> sides, ranges;
    std::vector<std::map<int, double>> entries;
    bool integer = false;
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string a, b, c, d;
        words >> a >> b >> c >> d;
        if (!line.starts_with(' ')) {
            section = a;
        } else if (section == "ROWS") {
            if (a == "N") continue;
            rows.emplace(b, static_cast<int>(rows.size()));
            senses.push_back(a[0]);
            sides.push_back(0.0);
            ranges.push_back(-1.0);
            entries.emplace_back();
        } else if (section == "COLUMNS" && b == "'MARKER'") {
            integer = c == "'INTORG'";
        } else if (section == "COLUMNS") {
            const auto [column, is_new] = columns.emplace(a, static_cast<int>(columns.size()));
            if (is_new) {
                read.program.add_column({"x", {column->second}}, 0.0, integer);
                read.columns.push_back(a);
            }
            if (b == "cost") read.program.columns.back().objective = std::stod(c);
            if (rows.contains(b)) entries[static_cast<std::size_t>(rows[b])][column->second] = std::stod(c);
        } else if (section == "RHS") {
            sides[static_cast<std::size_t>(rows.at(b))] = std::stod(c);
        } else if (section == "RANGES") {
            ranges[static_cast<std::size_t>(rows.at(b))] = std::stod(c);
        } else if (section == "BOUNDS") {
            auto& column = read.program.columns[static_cast<std::size_t>(columns.at(c))];
            (a == "LO" ? column.lower : column.upper) = std::stod(d);
        }
    }
    conelane::RowWriter writer(read.program);
    for (std::size_t row = 0; row < senses.size(); ++row) {
        const double low = ranges[row] >= 0.0   ? sides[row] - ranges[row]
                           : senses[row] == 'L' ? -conelane::kInfinity
                                                : sides[row];
        writer.begin({"r"}, low, senses[row] == 'G' ? conelane::kInfinity : sides[row]);
        for (const auto& [column, value] : entries[row]) writer.add(column, value);
        writer.end();
    }
    return read;
}

struct Solved {
    MilpReport report;
    NamedProgram read;
};

/// Writes the solution file in MIPLIB's format; a fault changes its content.
void write(const Solved& solved, const std::string& file, const std::string& fault) {
    if (fault == "no-file") return;
    std::ofstream out(file);
    out.precision(17);
    if (fault == "empty-file") return;
    if (fault == "garbage") {
        out << std::string(100000, 'x') << "\n\x01\xff\n";
        return;
    }
    if (fault == "claims-none" || solved.report.status != SolveStatus::optimal) {
        out << "=infeas=\n";
        return;
    }
    double objective = *solved.report.bound;
    if (fault == "wrong-objective") objective -= 0.5;
    out << "=obj= " << objective << "\n=solver= child 1.2\n=nodes= 3\n=ms= 0.5\n";
    if (fault != "mere-point") out << "=status= optimal\n";
    if (fault == "high-bound") out << "=bound= " << objective + 0.5 << '\n';
    if (fault == "low-bound") out << "=bound= " << objective - 0.5 << '\n';
    for (std::size_t c = 0; c < solved.report.point.size(); ++c) {
        double value = solved.report.point[c];
        const std::string& name = solved.read.columns[c];
        if (fault == "not-a-number" && c == 3) {
            out << name << " nan\n";
            continue;
        }
        if (fault == "fraction" && name.starts_with("a_") && value > 0.5) value = 0.75;
        if (fault == "half-a-point" && c % 2 == 0) value = 0.0;
        if (value != 0.0) out << name << ' ' << value << '\n';
    }
    if (fault == "unknown-column") out << "a_900_901 1\n";
    if (fault == "column-twice") out << solved.read.columns[0] << " 1\n" << solved.read.columns[0] << " 0\n";
}

/// Faults of a process before it answers.
void misbehave(const std::string& fault) {
    commit_process_fault(fault, R"({"status": ")");
    if (fault == "endless-lines") {
        for (const std::string block(1000, '\n');;) std::cout << block << std::flush;
    }
}

std::string fault_for(const std::string& fault, const std::string& marker) {
    if (marker == "always") return fault;
    if (std::filesystem::exists(marker)) return {};
    std::ofstream(marker) << "done\n";
    return fault;
}

Solved solve(const std::string& file) {
    NamedProgram read = read_mps(file);
    MilpReport report = conelane::kCbc.load(read.program)->solve({});
    return {std::move(report), std::move(read)};
}

}  // namespace

int main(int argument_count, char** arguments) {
    const std::vector<std::string> words(arguments + 1, arguments + argument_count);
    std::ofstream log;
    if (const char* const file = std::getenv("SOLVER_LOG")) log.open(file, std::ios::app);
    if (!words.empty() && words[0] == "once") {
        const std::string fault = words.size() > 4 ? fault_for(words[3], words[4]) : "";
        misbehave(fault);
        write(solve(words[1]), words[2], fault);
        return 0;
    }
    int count = 0;
    for (std::string line; std::getline(std::cin, line);) {
        if (log.is_open()) log << line << std::endl;
        const nlohmann::json question = nlohmann::json::parse(line);
        const bool at_fault = words.size() > 2 && ++count == std::stoi(words[1]);
        const std::string fault = at_fault ? fault_for(words[0], words[2]) : "";
        misbehave(fault);
        const Solved solved = solve(question.at("program"));
        write(solved, question.at("solution"), fault);
        nlohmann::json answer = nlohmann::json::object();
        if (fault == "says-error") answer = {{"status", "error"}, {"message", "no licence"}};
        if (fault == "wrong-type") answer = {{"status", 7}};
        if (fault == "unknown-status") answer = {{"status", "splendid"}};
        if (fault == "no-object") {
            std::cout << "[1, 2]" << std::endl;
            continue;
        }
        std::cout << answer << std::endl;
    }
}
