#include "experiments/tuning/evaluation.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/world/ground_truth.hpp"
#include "experiments/progress/parallel.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <utility>

namespace conelane::experiments {
namespace {

constexpr std::array<std::string_view, 4> kObjectives{"accuracy", "iou", "success", "usable"};

}  // namespace

std::optional<std::size_t> seen_count(const EvaluationOptions& options) {
    if (!options.nearest) return std::nullopt;
    return std::max(*options.nearest, options.context.value_or(0));
}

EvaluatedScene evaluate(RldSolver& solver, const Scene& scene, const RldParameters& parameters,
                        const EvaluationOptions& options) {
    const std::optional<std::size_t> count = seen_count(options);
    EvaluatedScene evaluated;
    evaluated.seen = count ? nearest_ahead(scene, *count) : scene;
    static_cast<SolvedScene&>(evaluated) =
        solve_scene(solver, evaluated.seen, parameters, {.limits = {options.time_limit_ms}});
    if (evaluated.report.status == SolveStatus::error) throw InvalidInput(scene.id, evaluated.report.message);
    if (!evaluated.report.lane_graph) return evaluated;
    evaluated.answer = answer_of(*evaluated.report.lane_graph, evaluated.seen, options);
    return evaluated;
}

LaneAnswer answer_of(const LaneGraph& graph, const Scene& seen, const EvaluationOptions& options) {
    LaneAnswer answer;
    std::optional<Lane> lane = to_lane(graph, seen);
    if (!lane) return answer;
    if (seen_count(options) > options.nearest) {
        *lane = cut_to_nearest(std::move(*lane), seen, *options.nearest);
        if (lane->left.empty() || lane->right.empty()) return answer;
    }
    answer.status = LaneStatus::found;
    answer.lane = std::move(*lane);
    return answer;
}

double value_of(const LaneAnswer& answer, const AnnotatedScene& scene, const TrackBoundaries& boundaries,
                const EvaluationOptions& options) {
    if (answer.status != LaneStatus::found) return 0.0;
    const SceneScore result = score(scene, answer, 0.0, options.nearest, &boundaries);
    if (options.objective == TuningObjective::iou) return result.iou.value_or(0.0);
    const bool is_good = options.objective == TuningObjective::accuracy ? result.accurate()
                         : options.objective == TuningObjective::usable ? result.usable().value_or(false)
                                                                        : result.success();
    return is_good ? 1.0 : 0.0;
}

std::span<const std::string_view> objective_names() {
    return kObjectives;
}

std::string_view to_string(TuningObjective objective) {
    return kObjectives[static_cast<std::size_t>(objective)];
}

Evaluation::Evaluation(SceneSet set, const EvaluationOptions& options)
    : set_(std::move(set)), options_(options) {
    std::erase_if(set_.scenes, [&](const AnnotatedScene& scene) {
        return !counts(scene) || (options_.objective == TuningObjective::accuracy && options_.nearest &&
                                  !ground_truth_of_nearest(scene, *options_.nearest));
    });
    if (set_.scenes.empty()) throw InvalidInput("--tracks", "no scene has a ground truth in its cone set");
}

std::vector<LapFigure> Evaluation::operator()(const RldParameters& parameters) const {
    const std::vector<AnnotatedScene>& scenes = set_.scenes;
    std::vector<double> values(scenes.size(), 0.0);
    std::atomic<std::size_t> timed_out{0};
    const double timed_out_limit = options_.max_timed_out * static_cast<double>(scenes.size());
    const auto abandoned = [&] { return static_cast<double>(timed_out.load()) > timed_out_limit; };
    in_parallel(
        scenes.size(), options_.threads, [] { return make_path_pair_solver(); },
        [&](std::unique_ptr<RldSolver>& solver, std::size_t i) {
            if (abandoned()) return;
            const EvaluatedScene evaluated = evaluate(*solver, scenes[i].scene, parameters, options_);
            const SolveStatus status = evaluated.report.status;
            if (status == SolveStatus::feasible || status == SolveStatus::stopped) {
                ++timed_out;
            } else if (evaluated.report.nodes <= options_.max_nodes) {
                values[i] = value_of(evaluated.answer, scenes[i], boundaries_of(scenes[i]), options_);
            }
        });
    std::vector<LapFigure> laps;
    const std::vector<std::size_t> starts = lap_starts(scenes);
    for (std::size_t lap = 0; lap + 1 < starts.size(); ++lap) {
        const AnnotatedScene& first = scenes[starts[lap]];
        LapFigure figure{first.track, first.false_positive_rate.value_or(0.0), first.range_m.value_or(0.0),
                         starts[lap + 1] - starts[lap], 0.0};
        for (std::size_t i = starts[lap]; i < starts[lap + 1] && !abandoned(); ++i) figure.sum += values[i];
        laps.push_back(std::move(figure));
    }
    return laps;
}

}  // namespace conelane::experiments
