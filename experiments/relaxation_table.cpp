#include "experiments/relaxation_table.hpp"

#include "experiments/files/figure_file.hpp"
#include "experiments/progress.hpp"
#include "experiments/scenes/ground_truth.hpp"
#include "experiments/scoring/score.hpp"
#include "experiments/scoring/statistics.hpp"
#include "model/invalid_input.hpp"
#include "model/lane_graph_problem.hpp"
#include "model/deadline.hpp"
#include "solvers/registry.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

constexpr std::string_view kExact = "path-pair";
constexpr double kAgreement = 1e-6;

std::vector<const AnnotatedScene*> scenes_of_size(std::span<const AnnotatedScene> scenes, std::size_t size,
                                                  std::optional<std::size_t> limit) {
    std::vector<const AnnotatedScene*> all;
    for (const AnnotatedScene& scene : scenes) {
        if (counts(scene) && nearest_ahead(scene.scene, size).cones.size() == size &&
            ground_truth_of_nearest(scene, size)) {
            all.push_back(&scene);
        }
    }
    if (!limit || all.size() <= *limit) return all;
    std::vector<const AnnotatedScene*> some;
    for (std::size_t i = 0; i < *limit; ++i) some.push_back(all[i * all.size() / *limit]);
    return some;
}

/// What the scenes of one row add up to.
class RowSums {
  public:
    RowSums(std::size_t cones, const RldSolverEntry& entry, const RelaxationOptions& options)
        : options_(options), solver_(entry.make(Formulation::tight)) {
        row_.cones = cones;
        row_.solver = entry.name;
    }

    /// `least`: the proven least cost; nothing in the exact solver's own row, which then gives it.
    std::optional<double> add(const AnnotatedScene& annotated, std::optional<double> least) {
        const Scene scene = nearest_ahead(annotated.scene, row_.cones);
        const Deadline deadline(options_.time_limit_ms);
        const Stopwatch watch;
        const LaneGraphProblem problem = make_problem(scene, options_.parameters, solver_->extent());
        const RldReport report = solver_->solve(problem, {deadline.remaining_ms()});
        times_ms_.push_back(watch.elapsed_ms());
        ++row_.scenes;
        if (report.status == SolveStatus::optimal) least = report.objective;
        LaneAnswer answer;
        if (report.lane_graph) {
            if (const std::optional<Lane> lane = to_lane(*report.lane_graph, scene)) {
                answer.status = LaneStatus::found;
                answer.lane = *lane;
            }
        }
        if (score(annotated, answer, times_ms_.back(), row_.cones, nullptr).accurate()) row_.accurate += 1.0;
        if (!least) return std::nullopt;
        ++row_.feasible;
        if (!report.objective) return least;
        if (*report.objective < *least - kAgreement) {
            throw InvalidInput(scene.id, fmt::format("{} answers {}, below the least cost {}", row_.solver,
                                                     *report.objective, *least));
        }
        ++row_.answered;
        if (*report.objective <= *least + kAgreement) ++row_.optimal;
        gaps_.push_back(std::max(0.0, *report.objective - *least) / std::max(1.0, std::abs(*least)));
        return least;
    }

    [[nodiscard]] RelaxationRow row() const {
        RelaxationRow row = row_;
        row.accurate /= static_cast<double>(row.scenes);
        if (!gaps_.empty()) {
            row.mean_gap = mean(gaps_);
            row.worst_gap = quantile(gaps_, 1.0);
        }
        row.median_ms = median(times_ms_);
        row.p95_ms = quantile(times_ms_, 0.95);
        row.worst_ms = quantile(times_ms_, 1.0);
        return row;
    }

  private:
    const RelaxationOptions& options_;
    std::unique_ptr<RldSolver> solver_;
    RelaxationRow row_;
    std::vector<double> gaps_, times_ms_;
};

double share(std::size_t part, std::size_t whole) {
    return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::string percent(const std::optional<double>& value) {
    return value ? fmt::format("{:.2f}", 100.0 * *value) : "-";
}

}  // namespace

std::vector<RelaxationRow> relaxation_rows(std::span<const AnnotatedScene> scenes,
                                           const RelaxationOptions& options) {
    std::vector<RelaxationRow> rows;
    for (const std::size_t size : options.sizes) {
        const std::vector<const AnnotatedScene*> of_size = scenes_of_size(scenes, size, options.limit);
        if (of_size.empty()) continue;
        Progress progress(fmt::format("n = {}", size), of_size.size());
        RowSums exact(size, *find_rld_solver(kExact), options);
        std::vector<RowSums> relaxations;
        for (const RldSolverEntry& entry : rld_solvers()) {
            if (!entry.exact) relaxations.emplace_back(size, entry, options);
        }
        for (const AnnotatedScene* scene : of_size) {
            const std::optional<double> least = exact.add(*scene, std::nullopt);
            for (RowSums& relaxation : relaxations) (void)relaxation.add(*scene, least);
            progress.advance();
        }
        rows.push_back(exact.row());
        for (const RowSums& relaxation : relaxations) rows.push_back(relaxation.row());
    }
    return rows;
}

std::string relaxation_table(std::span<const RelaxationRow> rows) {
    std::string table =
        fmt::format("{:>3} {:<12} {:>6} {:>8} {:>10} {:>9} {:>9} {:>11} {:>10} {:>9} {:>9} {:>9}\n", "n",
                    "solver", "scenes", "feasible", "answered %", "optimal %", "gap avg %", "gap worst %",
                    "accurate %", "median ms", "p95 ms", "worst ms");
    for (const RelaxationRow& row : rows) {
        table += fmt::format(
            "{:>3} {:<12} {:>6} {:>8} {:>10} {:>9} {:>9} {:>11} {:>10} {:>9.3f} {:>9.3f} {:>9.3f}\n",
            row.cones, row.solver, row.scenes, row.feasible, percent(share(row.answered, row.feasible)),
            percent(share(row.optimal, row.feasible)), percent(row.mean_gap), percent(row.worst_gap),
            percent(row.accurate), row.median_ms, row.p95_ms, row.worst_ms);
    }
    return table;
}

void write_relaxation_rows(const std::filesystem::path& file, std::span<const RelaxationRow> rows) {
    FigureFile output(file);
    for (const RelaxationRow& row : rows) {
        nlohmann::ordered_json json{{"cones", row.cones},       {"solver", row.solver},
                                    {"scenes", row.scenes},     {"feasible", row.feasible},
                                    {"answered", row.answered}, {"optimal", row.optimal}};
        if (row.mean_gap) json["mean_gap"] = *row.mean_gap;
        if (row.worst_gap) json["worst_gap"] = *row.worst_gap;
        json["accurate"] = row.accurate;
        json["median_ms"] = row.median_ms;
        json["p95_ms"] = row.p95_ms;
        json["worst_ms"] = row.worst_ms;
        output.add(std::move(json));
    }
    output.commit();
}

}  // namespace conelane::experiments
