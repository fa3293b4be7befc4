#include "evaluation/proofs/exact_program.hpp"

#include "conelane/lane_graph_problem.hpp"
#include "model/deadline.hpp"
#include "model/lane_graph_model.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <stdexcept>

namespace conelane {
namespace {

double magnitude(const Rational& value) {
    return Rational(abs(value)).convert_to<double>();
}

/// By how much the value is outside its bounds; kInfinity stands for an absent bound.
double outside(const Rational& value, double lower, double upper) {
    if (lower > -kInfinity && value < Rational(lower)) return magnitude(Rational(lower) - value);
    if (upper < kInfinity && value > Rational(upper)) return magnitude(value - Rational(upper));
    return 0.0;
}

void note_violation(ExactProgramReport& report, double violation, const Label& label) {
    if (violation <= report.violation) return;
    report.violation = violation;
    report.violated = to_string(label);
}

}  // namespace

double exact_difference(const Rational& exact, double stated) {
    return magnitude(exact - Rational(stated));
}

ExactProgramReport recompute_exactly(const BinaryProgram& program, std::span<const double> point) {
    ExactProgramReport report;
    report.rows = program.rows.size();
    double sum = 0.0;
    for (std::size_t c = 0; c < program.columns.size(); ++c) {
        const BinaryProgram::Column& column = program.columns[c];
        note_violation(report, outside(Rational(point[c]), column.lower, column.upper), column.label);
        if (point[c] == 0.0 || column.objective == 0.0) continue;
        report.objective += Rational(column.objective) * Rational(point[c]);
        sum += column.objective * point[c];
        ++report.terms;
    }
    report.objective_rounding = exact_difference(report.objective, sum);
    for (std::size_t r = 0; r < program.rows.size(); ++r) {
        Rational activity = 0;
        double rounded = 0.0;
        program.for_each_entry(r, [&](std::size_t column, double value) {
            if (point[column] == 0.0) return;
            activity += Rational(value) * Rational(point[column]);
            rounded += value * point[column];
            ++report.terms;
        });
        report.row_rounding = std::max(report.row_rounding, exact_difference(activity, rounded));
        const BinaryProgram::RowBounds& row = program.rows[r];
        note_violation(report, outside(activity, row.lower, row.upper), row.label);
    }
    return report;
}

std::vector<double> point_of(const BinaryProgram& program, const LaneGraph& graph,
                             const std::vector<bool>& near) {
    const std::set<Edge> chosen(graph.edges.begin(), graph.edges.end());
    std::vector<std::size_t> degree(near.size(), 0);
    for (const Edge& edge : graph.edges) {
        ++degree.at(edge.i);
        ++degree.at(edge.j);
    }
    std::size_t edges_met = 0;
    std::vector<double> point;
    point.reserve(program.columns.size());
    for (const BinaryProgram::Column& column : program.columns) {
        const std::string_view family = column.label.family;
        const auto first = static_cast<std::size_t>(column.label.index.first);
        const auto second = static_cast<std::size_t>(column.label.index.second);
        const auto third = static_cast<std::size_t>(column.label.index.third);
        const auto is_chosen = [&](std::size_t a, std::size_t b) { return chosen.contains(make_edge(a, b)); };
        bool value = false;
        if (family == "a") {
            value = is_chosen(first, second);
            if (value) ++edges_met;
        } else if (family == "f") {
            value = is_chosen(first, second) && is_chosen(second, third);
        } else if (family == "g") {
            value = degree.at(first) > 0;
        } else if (family == "u") {
            value = near.at(first) || degree.at(first) != 1;
        } else if (family == "e") {
            value = is_chosen(first, second) && degree.at(second) == 1;
        } else {
            throw std::invalid_argument("the column " + to_string(column.label) + " has no meaning");
        }
        point.push_back(value ? 1.0 : 0.0);
    }
    if (edges_met != chosen.size()) throw std::invalid_argument("an edge of the lane graph has no column");
    return point;
}

std::optional<ExactProgramReport> recompute_exactly(const Scene& scene, const RldParameters& parameters,
                                                    Formulation formulation, const LaneGraph& graph) {
    const Deadline never(std::numeric_limits<double>::infinity());
    const LimitedProblem limited = make_problem(scene, parameters, parts(formulation).extent, never);
    if (!limited.problem) return std::nullopt;
    LaneGraphModel model(formulation);
    if (model.update(*limited.problem, never)) return std::nullopt;
    const std::vector<double> point = point_of(model.program(), graph, limited.problem->near);
    ExactProgramReport report = recompute_exactly(model.program(), point);
    for (const ProgramRow& row : model.separate(point)) {
        Rational activity = 0;
        for (const auto& [column, value] : row.terms)
            activity += Rational(value) * Rational(point[static_cast<std::size_t>(column)]);
        note_violation(report, outside(activity, row.lower, row.upper), row.label);
    }
    return report;
}

}  // namespace conelane
