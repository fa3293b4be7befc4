#include "experiments/studies/formulations.hpp"

#include "conelane/invalid_input.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/studies/study.hpp"
#include "experiments/studies/study_options.hpp"
#include "experiments/studies/text_table.hpp"
#include "model/lane_graph_model.hpp"
#include "solvers/registry.hpp"
#include "solvers/relaxation/linear_relaxation.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

/// A formulation and its solver.
struct FormulatedSolver {
    Formulation formulation;
    std::string_view name;
};
constexpr std::array kFormulatedSolvers{FormulatedSolver{Formulation::tight, "cbc"},
                                        FormulatedSolver{Formulation::paper, "cbc-main"}};

std::unique_ptr<RldSolver> solver_of(const FormulatedSolver& solver) {
    const RldSolverEntry* entry = find_rld_solver(solver.name);
    if (entry == nullptr) {
        throw InvalidInput("solver", fmt::format("'{}' is not in this build", solver.name));
    }
    return entry->make(solver.formulation);
}

/// Sums over the scenes of one row.
class RowSums {
  public:
    RowSums(std::size_t cones, const FormulatedSolver& solver, const FormulationOptions& options)
        : options_(options), solver_(solver_of(solver)) {
        row_.cones = cones;
        row_.formulation = solver.formulation;
        row_.solver = solver.name;
    }

    /// The optimum, if it was proven.
    std::optional<double> add(const Scene& scene) {
        const auto [problem, report, solved_ms] =
            solve_scene(*solver_, scene, options_.parameters, {.limits = {options_.time_limit_ms}});
        if (report.status == SolveStatus::error) {
            throw InvalidInput(scene.id, row_.solver + " failed: " + report.message);
        }
        ++row_.scenes;
        build_ms_.push_back(report.build_ms);
        total_ms_.push_back(solved_ms);
        row_.mean_nodes += static_cast<double>(report.nodes);
        const LaneGraphModel model(problem, row_.formulation);
        const BinaryProgram& program = model.program();
        row_.columns += static_cast<double>(program.columns.size());
        row_.rows += static_cast<double>(program.rows.size());
        row_.entries += static_cast<double>(program.entry_values.size());
        if (report.status == SolveStatus::infeasible) ++row_.infeasible;
        if (report.status != SolveStatus::optimal) return std::nullopt;
        ++row_.optimal;
        if (const auto relaxed = linear_relaxation_optimum(program)) {
            gaps_.push_back((*report.objective - *relaxed) / std::max(1.0, std::abs(*report.objective)));
        }
        return report.objective;
    }

    [[nodiscard]] FormulationRow row() const {
        FormulationRow row = row_;
        const auto count = static_cast<double>(row.scenes);
        row.columns /= count;
        row.rows /= count;
        row.entries /= count;
        row.mean_nodes /= count;
        if (!gaps_.empty()) {
            row.median_gap = median(gaps_);
            row.mean_gap = mean(gaps_);
        }
        row.median_build_ms = median(build_ms_);
        row.median_ms = median(total_ms_);
        row.p95_ms = quantile(total_ms_, 0.95);
        return row;
    }

  private:
    const FormulationOptions& options_;
    std::unique_ptr<RldSolver> solver_;
    FormulationRow row_;
    std::vector<double> gaps_, build_ms_, total_ms_;
};

nlohmann::ordered_json to_json(const FormulationRow& row) {
    nlohmann::ordered_json json{{"cones", row.cones},     {"formulation", to_string(row.formulation)},
                                {"solver", row.solver},   {"scenes", row.scenes},
                                {"optimal", row.optimal}, {"infeasible", row.infeasible},
                                {"columns", row.columns}, {"rows", row.rows},
                                {"entries", row.entries}};
    if (row.median_gap) json["median_gap"] = *row.median_gap;
    if (row.mean_gap) json["mean_gap"] = *row.mean_gap;
    json["mean_nodes"] = row.mean_nodes;
    json["median_build_ms"] = row.median_build_ms;
    json["median_ms"] = row.median_ms;
    json["p95_ms"] = row.p95_ms;
    return json;
}

class FormulationsStudy : public Study {
  public:
    FormulationsStudy()
        : Study(
              {"formulations",
               "what does the tight formulation gain over the printed one: size, LP gap, nodes, time?",
               "The nearest cones of each scene that has as many; the tight formulation by cbc, the printed "
               "one by cbc-main, each the faster of the two on it; one thread. Times are wall clock with "
               "the making of the program. LP gap: (optimum - relaxation) / max(1, |optimum|), over the "
               "scenes with a proven optimum. The optima of both must be the same."}) {}

    void add_options(CLI::App& command) override {
        add_input_options(command, input_);
        add_cone_set_options(command, options_);
    }

    StudyResult run() override {
        options_.parameters = input_.parameters.load();
        const std::vector<FormulationRow> rows = formulation_rows(read_scenes(input_.scenes), options_);
        return study_result(formulation_table(rows), rows,
                            [](const FormulationRow& row) { return to_json(row); });
    }

  private:
    StudyInput input_;
    FormulationOptions options_;
};

}  // namespace

std::vector<FormulationRow> formulation_rows(std::span<const AnnotatedScene> scenes,
                                             const FormulationOptions& options) {
    std::vector<FormulationRow> rows;
    for (const std::size_t size : options.sizes) {
        const std::vector<const AnnotatedScene*> of_size =
            scenes_of_size(scenes, size, options.limit, [](const AnnotatedScene&) { return true; });
        if (of_size.empty()) continue;
        Progress progress(fmt::format("n = {}", size), of_size.size());
        RowSums tight(size, kFormulatedSolvers[0], options);
        RowSums paper(size, kFormulatedSolvers[1], options);
        for (const AnnotatedScene* annotated : of_size) {
            const Scene scene = nearest_ahead(annotated->scene, size);
            const std::optional<double> ours = tight.add(scene);
            const std::optional<double> printed = paper.add(scene);
            if (ours && printed && std::abs(*ours - *printed) > kObjectiveTolerance) {
                throw InvalidInput(scene.id,
                                   fmt::format("the optima differ: tight {}, paper {}", *ours, *printed));
            }
            progress.advance();
        }
        rows.push_back(tight.row());
        rows.push_back(paper.row());
    }
    return rows;
}

std::string formulation_table(std::span<const FormulationRow> rows) {
    TextTable table({{"n"},
                     {"form", true},
                     {"solver", true},
                     {"scenes"},
                     {"optimal"},
                     {"infeasible"},
                     {"columns"},
                     {"rows"},
                     {"entries"},
                     {"gap med %"},
                     {"gap avg %"},
                     {"nodes"},
                     {"build ms"},
                     {"median ms"},
                     {"p95 ms"}});
    for (const FormulationRow& row : rows) {
        table.add({std::to_string(row.cones), std::string(to_string(row.formulation)), row.solver,
                   std::to_string(row.scenes), std::to_string(row.optimal), std::to_string(row.infeasible),
                   fixed(row.columns, 0), fixed(row.rows, 0), fixed(row.entries, 0),
                   percent(row.median_gap, 2), percent(row.mean_gap, 2), fixed(row.mean_nodes, 1),
                   fixed(row.median_build_ms, 3), fixed(row.median_ms, 3), fixed(row.p95_ms, 3)});
    }
    return table.text();
}

std::unique_ptr<Study> make_formulations_study() {
    return std::make_unique<FormulationsStudy>();
}

}  // namespace conelane::experiments
