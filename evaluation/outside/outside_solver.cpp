#include "evaluation/outside/outside_solver.hpp"

#include "evaluation/seeded_random.hpp"
#include "model/connecting_flow.hpp"
#include "model/deadline.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace conelane {
namespace {

std::vector<std::size_t> drawn_order(std::size_t size, const std::string& name, std::uint64_t seed) {
    std::vector<std::size_t> order(size);
    std::iota(order.begin(), order.end(), std::size_t{0});
    boost::random::mt19937_64 random = generator_of(name, seed);
    shuffle(order, random);
    return order;
}

using Status = SolutionFile::Status;

/// Solvers round objectives and may print fewer digits.
constexpr double kObjectiveTolerance = 1e-5;

double tolerance(double value) {
    return kObjectiveTolerance * std::max(1.0, std::abs(value));
}

void add_rows(BinaryProgram& program, std::span<const ProgramRow> rows, int& count) {
    RowWriter writer(program);
    for (const ProgramRow& row : rows) {
        // Rows of different rounds may have the same name.
        writer.begin({"separated", {static_cast<std::int32_t>(count++)}}, row.lower, row.upper);
        for (const auto& [column, coefficient] : row.terms) writer.add(column, coefficient);
        writer.end();
    }
}

void fail(RldReport& report, std::string message) {
    report.status = SolveStatus::error;
    report.stopped_by.reset();
    report.message = std::move(message);
}

/// For an answer without a point: if no point is below the cutoff, the start is optimal.
void conclude_without_point(Status status, std::optional<double> cutoff, RldReport& report) {
    const bool has_start = report.lane_graph.has_value();
    if (status != Status::infeasible) {
        report.status = has_start ? SolveStatus::feasible : SolveStatus::stopped;
        report.stopped_by = StopReason::time;
        return;
    }
    report.status = has_start && cutoff ? SolveStatus::optimal : SolveStatus::infeasible;
    report.bound.reset();
    if (report.status == SolveStatus::optimal) report.bound = *cutoff;
    if (report.status == SolveStatus::infeasible) report.lane_graph.reset();
}

}  // namespace

std::vector<double> PermutedProgram::point_of(std::span<const double> point) const {
    if (point.empty()) return {};
    std::vector<double> first(column_of.size());
    for (std::size_t c = 0; c < first.size(); ++c) first[c] = point[column_of[c]];
    return first;
}

PermutedProgram permuted(const BinaryProgram& program, std::uint64_t seed) {
    PermutedProgram made;
    const std::vector<std::size_t> columns = drawn_order(program.columns.size(), "columns", seed);
    made.column_of.resize(columns.size());
    made.program.columns.reserve(columns.size());
    for (std::size_t place = 0; place < columns.size(); ++place) {
        made.column_of[columns[place]] = place;
        made.program.columns.push_back(program.columns[columns[place]]);
    }
    RowWriter writer(made.program);
    std::vector<std::pair<std::size_t, double>> terms;
    for (const std::size_t row : drawn_order(program.rows.size(), "rows", seed)) {
        terms.clear();
        program.for_each_entry(row, [&](std::size_t column, double value) {
            terms.emplace_back(made.column_of[column], value);
        });
        std::ranges::sort(terms);
        const BinaryProgram::RowBounds& bounds = program.rows[row];
        writer.begin(bounds.label, bounds.lower, bounds.upper);
        for (const auto& [column, value] : terms) writer.add(static_cast<int>(column), value);
        writer.end();
    }
    return made;
}

OutsideSolver::OutsideSolver(const OutsideDetector& detector, const OutsideSolverOptions& options)
    : program_(detector.source, options.patience), options_(options), model_(options.formulation) {}

void OutsideSolver::run(const LaneGraphProblem& problem, const SolveArguments& arguments, RldReport& report) {
    const Deadline deadline(arguments.limits.time_limit_ms);
    engine_ms_.reset();
    if (problem.edges.empty()) {
        report.status = SolveStatus::infeasible;
        return;
    }
    const Stopwatch build_watch;
    if (const auto struck = model_.update(problem, deadline)) {
        report.status = SolveStatus::stopped;
        report.stopped_by = struck;
        return;
    }
    BinaryProgram program = model_.program();
    if (options_.all_rows) add_connecting_flow(program, problem);
    report.build_ms = build_watch.elapsed_ms();
    const Stopwatch solve_watch;
    if (arguments.start != nullptr && is_feasible(problem, *arguments.start)) {
        report.objective = objective(problem, *arguments.start);
        report.lane_graph = *arguments.start;
    }
    solve_and_separate(problem, program, arguments.limits.absolute_gap, arguments.seed, deadline, report);
    report.solve_ms = solve_watch.elapsed_ms();
}

SolverProgram::Answer OutsideSolver::ask(const BinaryProgram& program, const SolverQuestion& question) {
    SolverProgram::Answer answer;
    if (question.seed == 0) {
        answer = program_.solve(program, question);
    } else {
        const PermutedProgram other = permuted(program, question.seed);
        answer = program_.solve(other.program, question);
        answer.solution.point = other.point_of(answer.solution.point);
    }
    if (!answer.solution.solver.empty()) version_ = answer.solution.solver;
    if (answer.solution.engine_ms) engine_ms_ = engine_ms_.value_or(0.0) + *answer.solution.engine_ms;
    return answer;
}

/// A lane graph in the report is the start: the solver looks for a better one.
void OutsideSolver::solve_and_separate(const LaneGraphProblem& problem, BinaryProgram& program,
                                       double absolute_gap, std::uint64_t seed, const Deadline& deadline,
                                       RldReport& report) {
    SolverQuestion question{deadline.remaining_ms(), absolute_gap, options_.threads, seed};
    if (report.lane_graph) question.cutoff = *report.objective - absolute_gap;
    int separated = 0;
    while (true) {
        question.time_limit_ms = deadline.remaining_ms();
        if (question.time_limit_ms <= 0.0) {
            conclude_without_point(Status::unknown, question.cutoff, report);
            return;
        }
        const auto [solution, fault] = ask(program, question);
        ++report.rounds;
        report.nodes += solution.nodes.value_or(0);
        if (!fault.empty()) return fail(report, fault);
        // Rows only tighten the program, so every round's bound holds for the problem. If an optimum comes
        // without a bound, the objective is the bound. With a cutoff, the bound is at most the cutoff.
        std::optional<double> bound = solution.bound;
        if (!bound && solution.status == Status::optimal) bound = solution.objective;
        if (bound && question.cutoff) bound = std::min(*bound, *question.cutoff);
        if (bound) report.bound = std::max(report.bound.value_or(*bound), *bound);
        if (solution.point.empty()) return conclude_without_point(solution.status, question.cutoff, report);
        const std::vector<ProgramRow> violated = model_.separate(solution.point);
        if (!violated.empty()) {
            if (options_.all_rows) return fail(report, "its point violates (5) or the pairing");
            add_rows(program, violated, separated);
            continue;
        }
        LaneGraph graph = model_.decode(solution.point);
        if (!is_feasible(problem, graph)) return fail(report, "its point is no lane graph");
        const double cost = objective(problem, graph);
        if (report.bound && *report.bound > cost + tolerance(cost))
            return fail(report, fmt::format("it claims the bound {:.9g}, its point has the objective {:.9g}",
                                            *report.bound, cost));
        if (solution.status == Status::optimal && report.lane_graph &&
            cost > *report.objective + absolute_gap + tolerance(cost))
            return fail(report, "the start is cheaper than its optimum");
        report.status = solution.status == Status::optimal ? SolveStatus::optimal : SolveStatus::feasible;
        if (report.status == SolveStatus::feasible) report.stopped_by = StopReason::time;
        if (report.status == SolveStatus::optimal && !report.bound) report.bound = cost;
        if (!report.lane_graph || cost < *report.objective) {
            report.objective = cost;
            report.lane_graph = std::move(graph);
        }
        report.bound =
            report.bound ? std::optional(std::min(*report.bound, *report.objective)) : std::nullopt;
        const bool is_apart = report.bound && *report.objective - *report.bound >
                                                  std::max(absolute_gap, tolerance(*report.objective));
        if (report.status == SolveStatus::optimal && is_apart) {
            report.status = SolveStatus::feasible;
            report.message = fmt::format("its optimum is proven to a gap of {:.3g} only",
                                         *report.objective - *report.bound);
        }
        return;
    }
}

}  // namespace conelane
