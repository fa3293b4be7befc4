#include "conelane/invalid_input.hpp"
#include "conelane/lane_graph_problem.hpp"
#include "experiments/studies/solve_study.hpp"
#include "experiments/studies/study.hpp"
#include "model/deadline.hpp"
#include "model/lane_graph_model.hpp"
#include "model/strip_model.hpp"
#include "solvers/milp/strip_milp.hpp"
#include "solvers/relaxation/linear_relaxation.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

/// A solve, and its program. A solve that reached the time limit counts with its time.
struct ProgramRow : SolveRow {
    std::size_t columns = 0;
    std::size_t rows = 0;
    std::size_t entries = 0;
    /// (optimum - relaxation) / max(1, |optimum|); absent without a proven optimum
    std::optional<double> gap = {};
    bool is_strip = false;
    /// Whether the relaxation has no fractional value; absent without a proven optimum
    std::optional<bool> is_integral = {};

    [[nodiscard]] std::string form() const {
        return is_strip ? "strip" : std::string(to_string(backend.formulation));
    }
};

/// Adds size and relaxation of the program.
void measure_program(const BinaryProgram& program, ProgramRow& row) {
    row.columns = program.columns.size();
    row.rows = program.rows.size();
    row.entries = program.entry_values.size();
    if (!row.is_optimal()) return;
    if (const auto relaxed = linear_relaxation(program)) {
        row.gap = (*row.objective - relaxed->optimum) / std::max(1.0, std::abs(*row.objective));
        row.is_integral = relaxed->is_integral;
    }
}

ProgramRow with_program(SolveRow solve, const RldParameters& parameters) {
    const Formulation formulation = solve.backend.formulation;
    const LaneGraphModel model(
        make_problem(cones_of(*solve.scene, solve.size), parameters, parts(formulation).extent), formulation);
    ProgramRow row{std::move(solve)};
    measure_program(model.program(), row);
    return row;
}

/// The strip program with its hand-set costs on the same cones, by its own search and by every
/// backend. Throws InvalidInput naming the scene where two optima differ.
std::vector<ProgramRow> strip_rows(const SolveRow& cones, double time_limit_ms) {
    const StripParameters parameters = driving_strip_parameters();
    const Scene scene = cones_of(*cones.scene, cones.size);
    std::vector<ProgramRow> rows;
    const auto add = [&](std::string_view solver, const auto& solve) {
        ProgramRow row;
        row.scene = cones.scene;
        row.size = cones.size;
        row.backend.solver = solver;
        row.is_strip = true;
        const Stopwatch watch;
        const StripProblem problem = make_strip_problem(scene, parameters);
        row.build_ms = watch.elapsed_ms();
        const StripReport report = solve(problem);
        row.latency_ms = watch.elapsed_ms();
        row.build_ms += report.build_ms;
        if (report.status == SolveStatus::error) throw InvalidInput(cones.scene->scene.id, report.message);
        row.status = report.status;
        row.objective = report.objective;
        row.nodes = report.nodes;
        StripModel model(problem);
        if (!model.build(Deadline())) measure_program(model.program(), row);
        if (row.is_optimal() && !rows.empty() && rows.front().is_optimal() &&
            std::abs(*row.objective - *rows.front().objective) > kObjectiveTolerance)
            throw InvalidInput(cones.scene->scene.id, fmt::format("strip-search and {} differ", solver));
        rows.push_back(std::move(row));
    };
    StripSolver search;
    add("strip-search", [&](const StripProblem& problem) {
        return search.solve(problem, {.limits = {.time_limit_ms = time_limit_ms}});
    });
    for (const MilpBackend& backend : milp_backends()) {
        add(backend.entry.name, [&](const StripProblem& problem) {
            return solve_strip_by_milp(backend, problem, {.time_limit_ms = time_limit_ms});
        });
    }
    return rows;
}

/// Throws InvalidInput naming the scene where the formulations have different optima.
void require_same_optima(const std::vector<ProgramRow>& rows) {
    std::map<std::pair<std::size_t, const AnnotatedScene*>, double> optima;
    for (const ProgramRow& row : rows) {
        if (!row.is_optimal()) continue;
        const auto [known, is_new] = optima.emplace(std::pair(row.size, row.scene), *row.objective);
        if (std::abs(known->second - *row.objective) > kObjectiveTolerance) {
            throw InvalidInput(row.scene->scene.id, fmt::format("the optima differ: tight {}, paper {}",
                                                                known->second, *row.objective));
        }
    }
}

class FormulationsStudy : public SolveStudy {
  public:
    FormulationsStudy()
        : SolveStudy(
              {"formulations",
               "what does the tight formulation gain over the printed one: size, LP gap, nodes, time?",
               "The nearest cones of each scene that has as many; the tight formulation by cbc, the printed "
               "one by cbc-main, each the faster of the two on it; one thread. Times are wall clock with "
               "the making of the program. LP gap: (optimum - relaxation) / max(1, |optimum|), over the "
               "scenes with a proven optimum. The optima of both must be the same."},
              {.backends = {{"cbc"}, {"cbc-main", Formulation::paper}},
               .sizes = {6, 8, 10, 12, 16, 20, 24, 30},
               .time_limit_ms = 10'000.0}) {}

    void add_options(CLI::App& command) override {
        SolveStudy::add_options(command);
        command.add_flag(
            "--strip", with_strip_,
            "also the strip program with its hand-set costs, by every MILP backend and its own search");
    }

  protected:
    StudyResult aggregate(const SceneSet& set, SolveOptions solves) override {
        std::vector<ProgramRow> rows;
        std::vector<ProgramRow> strips;
        for (SolveRow& row : solved_scenes(set.scenes, solves)) {
            if (with_strip_ && row.backend.formulation == Formulation::tight)
                std::ranges::move(strip_rows(row, solves.time_limit_ms), std::back_inserter(strips));
            rows.push_back(with_program(std::move(row), solves.parameters));
        }
        require_same_optima(rows);
        std::ranges::move(strips, std::back_inserter(rows));
        using Row = ProgramRow;
        using Group = RowGroup<Row>;
        const RowFields<Group> fields{
            {"cones", first_of(&Row::size)},
            {"", first_of(&Row::size_text), Shown::number("n")},
            {"formulation", first_of(&Row::form), Shown::text("form")},
            {"solver", first_of([](const Row& row) { return row.backend.solver; }), Shown::text("solver")},
            {"scenes", &Group::size, Shown::number("scenes")},
            {"optimal", count_of(&Row::is_optimal), Shown::number("optimal")},
            {"infeasible", count_of(&Row::is_infeasible), Shown::number("infeasible")},
            {"columns", mean_of(&Row::columns), Shown::fixed("columns", 0)},
            {"rows", mean_of(&Row::rows), Shown::fixed("rows", 0)},
            {"entries", mean_of(&Row::entries), Shown::fixed("entries", 0)},
            {"integral", mean_of(&Row::is_integral), Shown::percent("integral %", 1)},
            {"median_gap", median_of(&Row::gap), Shown::percent("gap med %", 2)},
            {"mean_gap", mean_of(&Row::gap), Shown::percent("gap avg %", 2)},
            {"mean_nodes", mean_of(&Row::nodes), Shown::fixed("nodes", 1)},
            {"median_build_ms", median_of(&Row::build_ms), Shown::fixed("build ms", 3)},
            {"median_ms", median_of(&Row::latency_ms), Shown::fixed("median ms", 3)},
            {"p95_ms", quantile_of(&Row::latency_ms, 0.95), Shown::fixed("p95 ms", 3)}};
        return study_result(
            groups_of<Row>(
                rows, [](const Row& row) { return std::tuple(row.size, row.form(), row.backend.solver); }),
            fields);
    }

  private:
    bool with_strip_ = false;
};

}  // namespace

std::unique_ptr<Study> make_formulations_study() {
    return std::make_unique<FormulationsStudy>();
}

}  // namespace conelane::experiments
