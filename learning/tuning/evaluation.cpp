#include "learning/tuning/evaluation.hpp"

#include "conelane/invalid_input.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/progress/parallel.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/world/ground_truth.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <numeric>
#include <utility>

namespace conelane::learning {
namespace {

constexpr std::array<std::string_view, 4> kObjectives{"accuracy", "iou", "success", "usable"};

/// The lane of least cost, found among the cones of the context and cut to the cone set; no lane if nothing
/// is left.
LaneAnswer answer_of(const SolvedScene& solved, const Scene& seen, const EvaluationOptions& options) {
    LaneAnswer answer;
    if (!solved.report.lane_graph) return answer;
    std::optional<Lane> lane = to_lane(*solved.report.lane_graph, seen);
    if (!lane) return answer;
    if (options.context > options.nearest) {
        *lane = cut_to_nearest(std::move(*lane), seen, *options.nearest);
        if (lane->left.empty() || lane->right.empty()) return answer;
    }
    answer.status = LaneStatus::found;
    answer.lane = std::move(*lane);
    return answer;
}

/// The value of an answer under the objective, in [0, 1]; 0 without a lane.
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

}  // namespace

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

double Evaluation::operator()(const RldParameters& parameters) const {
    const std::vector<AnnotatedScene>& scenes = set_.scenes;
    std::vector<double> values(scenes.size(), 0.0);
    std::atomic<std::size_t> timed_out{0};
    const auto count = static_cast<double>(scenes.size());
    const auto abandoned = [&] {
        return static_cast<double>(timed_out.load()) > options_.max_timed_out * count;
    };
    in_parallel(
        scenes.size(), options_.threads, [] { return make_path_pair_solver(); },
        [&](std::unique_ptr<RldSolver>& solver, std::size_t i) {
            if (abandoned()) return;
            const Scene& scene = scenes[i].scene;
            const std::optional<std::size_t> most = std::max(options_.nearest, options_.context);
            const Scene seen = most ? nearest_ahead(scene, *most) : scene;
            const SolvedScene solved =
                solve_scene(*solver, seen, parameters, {.limits = {options_.time_limit_ms}});
            const SolveStatus status = solved.report.status;
            if (status == SolveStatus::error) throw InvalidInput(scene.id, solved.report.message);
            if (status == SolveStatus::feasible || status == SolveStatus::stopped) {
                ++timed_out;
            } else if (solved.report.nodes <= options_.max_nodes) {
                values[i] = value_of(answer_of(solved, seen, options_), scenes[i],
                                     set_.tracks.at(scenes[i].track), options_);
            }
        });
    return abandoned() ? 0.0 : std::accumulate(values.begin(), values.end(), 0.0) / count;
}

}  // namespace conelane::learning
