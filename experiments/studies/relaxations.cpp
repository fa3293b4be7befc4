#include "experiments/studies/relaxations.hpp"

#include "conelane/invalid_input.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "evaluation/world/ground_truth.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/studies/study.hpp"
#include "experiments/studies/study_options.hpp"
#include "experiments/studies/text_table.hpp"
#include "solvers/registry.hpp"

#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

constexpr std::string_view kExact = "path-pair";
/// Sums over the scenes of one row.
class RowSums {
  public:
    RowSums(std::size_t cones, const RldSolverEntry& entry, const RelaxationOptions& options)
        : options_(options), solver_(entry.make(Formulation::tight)) {
        row_.cones = cones;
        row_.solver = entry.name;
    }

    /// `least`: the proven least cost; absent in the exact solver's own row, which determines it.
    std::optional<double> add(const AnnotatedScene& annotated, std::optional<double> least,
                              AnswerErrors& errors) {
        const Scene scene = nearest_ahead(annotated.scene, row_.cones);
        const auto [problem, report, solved_ms] =
            solve_scene(*solver_, scene, options_.parameters, {.limits = {options_.time_limit_ms}});
        if (report.status == SolveStatus::error && row_.solver == kExact) {
            throw InvalidInput(scene.id, report.message);
        }
        times_ms_.push_back(solved_ms);
        ++row_.scenes;
        const std::string name = fmt::format("{} n={}", row_.solver, row_.cones);
        if (report.status == SolveStatus::error) {
            errors.add_error(name, scene.id, report.message);
        } else {
            errors.add_answer(name);
        }
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
        if (*report.objective < *least - kObjectiveTolerance) {
            throw InvalidInput(scene.id, fmt::format("{} answers {}, below the least cost {}", row_.solver,
                                                     *report.objective, *least));
        }
        ++row_.answered;
        if (*report.objective <= *least + kObjectiveTolerance) ++row_.optimal;
        gaps_.push_back(relative_gap(*report.objective, *least));
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

nlohmann::ordered_json to_json(const RelaxationRow& row) {
    nlohmann::ordered_json json{{"cones", row.cones},       {"solver", row.solver},
                                {"scenes", row.scenes},     {"feasible", row.feasible},
                                {"answered", row.answered}, {"optimal", row.optimal}};
    if (row.mean_gap) json["mean_gap"] = *row.mean_gap;
    if (row.worst_gap) json["worst_gap"] = *row.worst_gap;
    json["accurate"] = row.accurate;
    json["median_ms"] = row.median_ms;
    json["p95_ms"] = row.p95_ms;
    json["worst_ms"] = row.worst_ms;
    return json;
}

class RelaxationsStudy : public Study {
  public:
    RelaxationsStudy()
        : Study({"relaxations",
                 "does relaxing the binary constraints decrease latency (RLD paper, V), and what does it "
                 "cost in accuracy?",
                 "The nearest cones of each scene that has enough cones and a ground truth among them; every "
                 "solver that proves nothing, and path-pair, which gives the optimum; one thread. Times are "
                 "wall clock, including making the problem. Gap: (objective - optimum) / max(1, |optimum|), "
                 "over the answers."}) {}

    void add_options(CLI::App& command) override {
        add_input_options(command, input_);
        add_cone_set_options(command, options_);
    }

    StudyResult run() override {
        options_.parameters = input_.parameters.load();
        AnswerErrors errors;
        const std::vector<RelaxationRow> rows = relaxation_rows(read_scenes(input_.scenes), options_, errors);
        StudyResult result =
            study_result(relaxation_table(rows), rows, [](const RelaxationRow& row) { return to_json(row); });
        result.errors = std::move(errors);
        return result;
    }

  private:
    StudyInput input_;
    RelaxationOptions options_;
};

}  // namespace

std::vector<RelaxationRow> relaxation_rows(std::span<const AnnotatedScene> scenes,
                                           const RelaxationOptions& options, AnswerErrors& errors) {
    std::vector<RelaxationRow> rows;
    for (const std::size_t size : options.sizes) {
        const auto has_ground_truth = [&](const AnnotatedScene& scene) {
            return counts(scene) && ground_truth_of_nearest(scene, size).has_value();
        };
        const std::vector<const AnnotatedScene*> of_size =
            scenes_of_size(scenes, size, options.limit, has_ground_truth);
        if (of_size.empty()) continue;
        Progress progress(fmt::format("n = {}", size), of_size.size());
        RowSums exact(size, *find_rld_solver(kExact), options);
        std::vector<RowSums> relaxations;
        for (const RldSolverEntry& entry : rld_solvers()) {
            if (!entry.has(SolverTrait::exact)) relaxations.emplace_back(size, entry, options);
        }
        for (const AnnotatedScene* scene : of_size) {
            const std::optional<double> least = exact.add(*scene, std::nullopt, errors);
            for (RowSums& relaxation : relaxations) (void)relaxation.add(*scene, least, errors);
            progress.advance();
        }
        rows.push_back(exact.row());
        for (const RowSums& relaxation : relaxations) rows.push_back(relaxation.row());
    }
    return rows;
}

std::string relaxation_table(std::span<const RelaxationRow> rows) {
    TextTable table({{"n"},
                     {"solver", true},
                     {"scenes"},
                     {"feasible"},
                     {"answered %"},
                     {"optimal %"},
                     {"gap avg %"},
                     {"gap worst %"},
                     {"accurate %"},
                     {"median ms"},
                     {"p95 ms"},
                     {"worst ms"}});
    for (const RelaxationRow& row : rows) {
        table.add({std::to_string(row.cones), row.solver, std::to_string(row.scenes),
                   std::to_string(row.feasible), percent(share(row.answered, row.feasible), 2),
                   percent(share(row.optimal, row.feasible), 2), percent(row.mean_gap, 2),
                   percent(row.worst_gap, 2), percent(row.accurate, 2), fixed(row.median_ms, 3),
                   fixed(row.p95_ms, 3), fixed(row.worst_ms, 3)});
    }
    return table.text();
}

std::unique_ptr<Study> make_relaxations_study() {
    return std::make_unique<RelaxationsStudy>();
}

}  // namespace conelane::experiments
