#include "experiments/studies/optimality.hpp"

#include "conelane/check.hpp"
#include "conelane/invalid_input.hpp"
#include "conelane/lane_graph_problem.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/files/json_node.hpp"
#include "evaluation/scenes/scene_file.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "experiments/comparison/answer_check.hpp"
#include "experiments/comparison/known_detectors.hpp"
#include "experiments/comparison/runner.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/studies/cone_sets.hpp"
#include "experiments/studies/study.hpp"
#include "experiments/studies/study_options.hpp"
#include "experiments/studies/text_table.hpp"
#include "solvers/registry.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace conelane::experiments {
namespace {

/// Lanes are measured by the objective with these parameters; most detectors have none.
std::unique_ptr<LaneDetector> made(const KnownDetector& detector, const OptimalityOptions& options) {
    return make_detector(detector, options_used_by(detector, {options.parameters, {}, options.nearest}));
}

/// One lap, with the state that a detector keeps along it.
class Lap {
  public:
    Lap(const TrackBoundariesByName& tracks, const OptimalityOptions& options)
        : tracks_(tracks),
          options_(options),
          solver_(find_rld_solver("path-pair")->make(Formulation::tight)),
          detector_(made(find_detector(options.detector), options)) {}

    OptimalityRow drive(const AnnotatedScene& annotated) {
        const Scene cones =
            options_.nearest ? nearest_ahead(annotated.scene, *options_.nearest) : annotated.scene;
        OptimalityRow row;
        row.scene = &annotated;
        const auto [problem, report, solved_ms] =
            solve_scene(*solver_, cones, options_.parameters, {options_.time_limit_ms});
        if (report.status == SolveStatus::error) throw InvalidInput(cones.id, report.message);
        take_optimum(row, report, cones);
        const LaneAnswer answer =
            detector_->detect(annotated.scene, {std::numeric_limits<double>::infinity(), true});
        if (!answer.enumeration)
            throw InvalidInput("method", "'" + options_.detector + "' does not enumerate");
        if (answer.status == LaneStatus::found)
            row.choice = with_objective(answer.lane, problem, cones, annotated);
        compare_candidates(row, answer.enumeration->candidates, problem, cones);
        return row;
    }

  private:
    void take_optimum(OptimalityRow& row, const RldReport& report, const Scene& cones) const {
        row.status = report.status;
        row.bound = report.bound;
        if (!report.lane_graph) return;
        const Claim claim{report.status == SolveStatus::optimal, *report.objective, report.bound};
        require_accepted(check(cones, options_.parameters, *report.lane_graph, claim), cones.id, "optimum");
        if (const auto lane = to_lane(*report.lane_graph, cones)) {
            row.optimum = judged(*lane, *row.scene);
            row.optimum->objective = report.objective;
        }
    }

    void compare_candidates(OptimalityRow& row, const std::vector<LaneCandidate>& candidates,
                            const LaneGraphProblem& problem, const Scene& cones) const {
        std::set<std::vector<Edge>> met;
        const Lane* best = nullptr;
        double least = 0.0;
        for (const LaneCandidate& candidate : candidates) {
            const auto graph = lane_graph_of(candidate.lane, cones);
            if (!graph || !met.insert(graph->edges).second) continue;
            ++row.candidates;
            if (!is_feasible(problem, *graph)) continue;
            ++row.feasible;
            const double value = objective(problem, *graph);
            if (best != nullptr && value >= least) continue;
            best = &candidate.lane;
            least = value;
        }
        if (best == nullptr) return;
        require_accepted(check(cones, options_.parameters, *lane_graph_of(*best, cones), {false, least, {}}),
                         cones.id, "candidate");
        if (row.status == SolveStatus::infeasible) {
            throw InvalidInput(cones.id,
                               "a candidate is feasible, but the exact search proved that there is none");
        }
        if (row.status == SolveStatus::optimal && least < *row.optimum->objective - kObjectiveTolerance) {
            throw InvalidInput(
                cones.id, fmt::format("a candidate has the objective {}, below the proven optimum {}", least,
                                      *row.optimum->objective));
        }
        row.candidate = judged(*best, *row.scene);
        row.candidate->objective = least;
    }

    [[nodiscard]] JudgedLane with_objective(const Lane& lane, const LaneGraphProblem& problem,
                                            const Scene& cones, const AnnotatedScene& annotated) const {
        JudgedLane result = judged(lane, annotated);
        const auto graph = lane_graph_of(lane, cones);
        if (graph && is_feasible(problem, *graph)) result.objective = objective(problem, *graph);
        return result;
    }

    [[nodiscard]] JudgedLane judged(const Lane& lane, const AnnotatedScene& annotated) const {
        const auto track = tracks_.find(annotated.track);
        LaneAnswer answer;
        answer.status = LaneStatus::found;
        answer.lane = lane;
        const SceneScore result = score(annotated, answer, 0.0, options_.nearest,
                                        track == tracks_.end() ? nullptr : &track->second);
        return {{}, result.category, result.iou.value_or(0.0)};
    }

    static void require_accepted(const CheckReport& report, const std::string& scene, const char* what) {
        if (report.violations.empty()) return;
        throw InvalidInput(scene, fmt::format("the checker rejects the {}: {}", what, report.violations[0]));
    }

    const TrackBoundariesByName& tracks_;
    const OptimalityOptions& options_;
    std::unique_ptr<RldSolver> solver_;
    std::unique_ptr<LaneDetector> detector_;
};

nlohmann::ordered_json to_json(const JudgedLane& lane) {
    nlohmann::ordered_json json{{"category", to_string(lane.category)}, {"iou", lane.iou}};
    if (lane.objective) json["objective"] = *lane.objective;
    return json;
}

nlohmann::ordered_json to_json(const OptimalityRow& row, const OptimalityOptions& options) {
    const AnnotatedScene& scene = *row.scene;
    nlohmann::ordered_json json{{"scene", scene.scene.id}, {"track", scene.track}};
    if (scene.false_positive_rate) json["false_positive_rate"] = *scene.false_positive_rate;
    if (scene.range_m) json["range"] = *scene.range_m;
    json["method"] = options.detector;
    if (options.nearest) json["nearest"] = *options.nearest;
    json["status"] = to_string(row.status);
    if (row.bound) put_bound(json, *row.bound, "bound");
    json["candidates"] = row.candidates;
    json["feasible_candidates"] = row.feasible;
    if (row.optimum) json["optimum"] = to_json(*row.optimum);
    if (row.candidate) json["candidate"] = to_json(*row.candidate);
    if (row.choice) json["choice"] = to_json(*row.choice);
    if (const auto gap = row.gap()) {
        json["gap"] = *gap;
        json["equal"] = row.is_optimal();
    }
    return json;
}

/// Sums over the rows of one rate of false positives.
struct Sums {
    std::size_t scenes = 0, proven = 0, candidates = 0, feasible = 0, compared = 0, equal = 0;
    std::size_t optimum_successes = 0, candidate_successes = 0;
    std::vector<double> gaps, optimum_ious, candidate_ious;

    void add(const OptimalityRow& row) {
        ++scenes;
        candidates += row.candidates;
        feasible += row.feasible;
        if (row.status == SolveStatus::optimal || row.status == SolveStatus::infeasible) ++proven;
        const auto gap = row.gap();
        if (!gap) return;
        ++compared;
        gaps.push_back(*gap);
        if (row.is_optimal()) ++equal;
        if (is_success(row.optimum->category)) ++optimum_successes;
        if (is_success(row.candidate->category)) ++candidate_successes;
        optimum_ious.push_back(row.optimum->iou);
        candidate_ious.push_back(row.candidate->iou);
    }
};

class OptimalityStudy : public Study {
  public:
    OptimalityStudy()
        : Study(
              {"optimality",
               "how far from the optimum of RLD's objective is the best lane that CLC enumerates, and does "
               "the optimum drive better?",
               "Every scene with a ground truth is solved by path-pair on the cone set that the enumerating "
               "method gets. Of the method's candidates those that RLD's constraints allow are compared by "
               "RLD's objective (29); gap: (candidate - optimum) / max(1, |optimum|). Nothing is timed."}) {}

    void add_options(CLI::App& command) override {
        add_input_options(command, input_);
        command.add_option("--method", options_.detector, "a method that enumerates")->capture_default_str();
        add_nearest_option(command, options_.nearest, "the N nearest cones ahead only; all without it");
        add_time_limit_option(command, options_.time_limit_ms);
        add_threads_option(command, options_.threads, "number of threads; nothing is timed");
    }

    StudyResult run() override {
        options_.parameters = input_.parameters.load();
        const std::vector<AnnotatedScene> scenes = read_scenes(input_.scenes);
        TrackBoundariesByName tracks;
        const std::filesystem::path boundaries = track_boundaries_path(input_.scenes);
        if (std::filesystem::exists(boundaries)) tracks = read_track_boundaries(boundaries);
        const std::vector<OptimalityRow> rows = optimality_rows(scenes, tracks, options_);
        return study_result(optimality_table(rows), rows,
                            [&](const OptimalityRow& row) { return to_json(row, options_); });
    }

  private:
    StudyInput input_;
    OptimalityOptions options_;
};

}  // namespace

std::optional<double> OptimalityRow::gap() const {
    if (status != SolveStatus::optimal || !candidate) return std::nullopt;
    return relative_gap(*candidate->objective, *optimum->objective);
}

bool OptimalityRow::is_optimal() const {
    return gap() && *candidate->objective - *optimum->objective <= kObjectiveTolerance;
}

std::vector<OptimalityRow> optimality_rows(std::span<const AnnotatedScene> scenes,
                                           const TrackBoundariesByName& tracks,
                                           const OptimalityOptions& options) {
    (void)find_detector(options.detector);
    const std::vector<std::size_t> starts = lap_starts(scenes);
    std::vector<OptimalityRow> rows(scenes.size());
    Progress progress("optimality", scenes.size());
    oneapi::tbb::task_arena arena(
        std::min(static_cast<int>(options.threads), oneapi::tbb::info::default_concurrency()));
    arena.execute([&] {
        oneapi::tbb::parallel_for(std::size_t{0}, starts.size() - 1, [&](std::size_t lap) {
            Lap driven(tracks, options);
            for (std::size_t i = starts[lap]; i < starts[lap + 1]; ++i) {
                if (counts(scenes[i])) rows[i] = driven.drive(scenes[i]);
                progress.advance();
            }
        });
    });
    std::erase_if(rows, [](const OptimalityRow& row) { return row.scene == nullptr; });
    return rows;
}

std::string optimality_table(std::span<const OptimalityRow> rows) {
    std::map<std::optional<double>, Sums> by_rate;
    for (const OptimalityRow& row : rows) by_rate[row.scene->false_positive_rate].add(row);
    TextTable table({{"fp %"},
                     {"scenes"},
                     {"proven %"},
                     {"feasible candidates %"},
                     {"compared"},
                     {"equal %"},
                     {"median gap %"},
                     {"p95 gap %"},
                     {"success % opt / cand"},
                     {"IoU % opt / cand"}});
    for (const auto& [rate, sums] : by_rate) {
        const auto figure = [](const std::vector<double>& values, auto of) {
            return values.empty() ? std::nullopt : std::optional<double>(of(values));
        };
        const auto p95 = [](const std::vector<double>& values) { return quantile(values, 0.95); };
        const auto middle = [](const std::vector<double>& values) { return median(values); };
        const auto average = [](const std::vector<double>& values) { return mean(values); };
        table.add({percent(rate, 1), std::to_string(sums.scenes), percent(share(sums.proven, sums.scenes), 1),
                   percent(share(sums.feasible, sums.candidates), 1), std::to_string(sums.compared),
                   percent(share(sums.equal, sums.compared), 1), percent(figure(sums.gaps, middle), 3),
                   percent(figure(sums.gaps, p95), 3),
                   percent(share(sums.optimum_successes, sums.compared), 1) + " / " +
                       percent(share(sums.candidate_successes, sums.compared), 1),
                   percent(figure(sums.optimum_ious, average), 1) + " / " +
                       percent(figure(sums.candidate_ious, average), 1)});
    }
    return table.text();
}

std::unique_ptr<Study> make_optimality_study() {
    return std::make_unique<OptimalityStudy>();
}

}  // namespace conelane::experiments
