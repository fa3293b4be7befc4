#include "experiments/formulation_table.hpp"

#include "experiments/files/figure_file.hpp"
#include "experiments/progress.hpp"
#include "experiments/scoring/statistics.hpp"
#include "model/invalid_input.hpp"
#include "model/lane_graph_model.hpp"
#include "model/deadline.hpp"
#include "solvers/linear_relaxation.hpp"
#include "solvers/registry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

struct Contestant {
    Formulation formulation;
    std::string_view solver;
};
constexpr std::array kContestants{Contestant{Formulation::tight, "cbc"},
                                  Contestant{Formulation::paper, "cbc-main"}};
constexpr double kAgreement = 1e-6;

std::vector<Scene> scenes_of_size(std::span<const AnnotatedScene> scenes, std::size_t size,
                                  std::optional<std::size_t> limit) {
    std::vector<Scene> all;
    for (const AnnotatedScene& annotated : scenes) {
        Scene scene = nearest_ahead(annotated.scene, size);
        if (scene.cones.size() == size) all.push_back(std::move(scene));
    }
    if (!limit || all.size() <= *limit) return all;
    std::vector<Scene> some;
    for (std::size_t i = 0; i < *limit; ++i) some.push_back(std::move(all[i * all.size() / *limit]));
    return some;
}

/// What the scenes of one row add up to.
class RowSums {
  public:
    RowSums(std::size_t cones, const Contestant& contestant, const FormulationOptions& options)
        : options_(options), solver_(find_rld_solver(contestant.solver)->make(contestant.formulation)) {
        row_.cones = cones;
        row_.formulation = contestant.formulation;
        row_.solver = contestant.solver;
    }

    /// The optimum, where it was proven.
    std::optional<double> add(const Scene& scene) {
        const Stopwatch watch;
        const LaneGraphProblem problem = make_problem(scene, options_.parameters, solver_->extent());
        const double problem_ms = watch.elapsed_ms();
        const RldReport report = solver_->solve(problem, {options_.time_limit_ms});
        if (report.status == SolveStatus::error) {
            throw InvalidInput(scene.id, row_.solver + " failed: " + report.message);
        }
        ++row_.scenes;
        build_ms_.push_back(problem_ms + report.build_ms);
        total_ms_.push_back(problem_ms + report.build_ms + report.solve_ms);
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

std::string percent(const std::optional<double>& share) {
    return share ? fmt::format("{:.2f}", 100.0 * *share) : "-";
}

}  // namespace

std::vector<FormulationRow> formulation_rows(std::span<const AnnotatedScene> scenes,
                                             const FormulationOptions& options) {
    std::vector<FormulationRow> rows;
    for (const std::size_t size : options.sizes) {
        const std::vector<Scene> of_size = scenes_of_size(scenes, size, options.limit);
        if (of_size.empty()) continue;
        Progress progress(fmt::format("n = {}", size), of_size.size());
        RowSums tight(size, kContestants[0], options);
        RowSums paper(size, kContestants[1], options);
        for (const Scene& scene : of_size) {
            const std::optional<double> ours = tight.add(scene);
            const std::optional<double> printed = paper.add(scene);
            if (ours && printed && std::abs(*ours - *printed) > kAgreement) {
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
    std::string table = fmt::format(
        "{:>3} {:<6} {:<9} {:>6} {:>8} {:>10} {:>8} {:>8} {:>9} {:>9} {:>9} {:>8} {:>9} {:>9} {:>9}\n", "n",
        "form", "solver", "scenes", "optimal", "infeasible", "columns", "rows", "entries", "gap med %",
        "gap avg %", "nodes", "build ms", "median ms", "p95 ms");
    for (const FormulationRow& row : rows) {
        table += fmt::format(
            "{:>3} {:<6} {:<9} {:>6} {:>8} {:>10} {:>8.0f} {:>8.0f} {:>9.0f} {:>9} {:>9} {:>8.1f} {:>9.3f} "
            "{:>9.3f} "
            "{:>9.3f}\n",
            row.cones, to_string(row.formulation), row.solver, row.scenes, row.optimal, row.infeasible,
            row.columns, row.rows, row.entries, percent(row.median_gap), percent(row.mean_gap),
            row.mean_nodes, row.median_build_ms, row.median_ms, row.p95_ms);
    }
    return table;
}

void write_formulation_rows(const std::filesystem::path& file, std::span<const FormulationRow> rows) {
    FigureFile output(file);
    for (const FormulationRow& row : rows) {
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
        output.add(std::move(json));
    }
    output.commit();
}

}  // namespace conelane::experiments
