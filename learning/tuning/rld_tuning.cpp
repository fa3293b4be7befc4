#include "learning/tuning/rld_tuning.hpp"

#include "conelane/solve_scene.hpp"
#include "evaluation/progress/parallel.hpp"
#include "evaluation/scoring/score.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"

#include <atomic>
#include <exception>
#include <numeric>

#include <nlopt.hpp>

namespace conelane::learning {
namespace {

using P = RldParameters;

/// A limit that cuts off lanes of an unseen track costs more than a tight limit gains on the seen tracks:
/// with all limits free, a fold lost 12 points of accuracy on a track with cones 0.9 m apart. So the ranges
/// of limits begin at values that exclude no real lane: turns of 70 degrees (t_crit), spacings 2.7 m off d_e
/// (s_crit), lanes 2.8 m wide (d_min), first cones 5 m away (d_near), far ends the widest lane apart (d_max),
/// two edges near a car that is across a bend (d_h, theta_heading). d_e ends at the largest spacing of the
/// rules.
///
/// With shape costs, the limits stay: these costs distinguish false edges without excluding true ones, and
/// with tuned limits fewer lanes of held-out tracks were accurate.
constexpr std::size_t kShape = 7;
constexpr std::size_t kCosts = 4;
constexpr std::size_t kLimits = 7;
constexpr std::array<TunedParameter, kShape + kCosts + kLimits> kTuned{{
    {"w_u", &P::unevenness_weight, 0.01, 3.0, true},
    {"w_v", &P::facing_weight, 0.02, 5.0, true},
    {"w_n", &P::near_end_weight, 0.02, 5.0, true},
    {"d_w", &P::lane_width_m, 3.0, 5.0, false},
    {"d_v", &P::facing_distance_m, 0.5, 4.0, true},
    {"theta_v", &P::facing_angle_rad, 0.1, 1.5, true},
    {"d_l", &P::facing_length_m, 0.5, 10.0, true},
    {"d_e", &P::d_e, 1.5, 5.0, false},
    {"w_s", &P::w_s, 0.01, 3.0, true},
    {"w_t", &P::w_t, 0.02, 5.0, true},
    {"w_p", &P::w_p, 0.005, 10.0, true},
    {"d_min", &P::d_min, 1.5, 2.8, false},
    {"d_h", &P::d_h, 5.5, 12.0, false},
    {"theta_heading", &P::theta_heading, 1.2, 1.55, false},
    {"d_near", &P::d_near, 5.1, 12.0, false},
    {"d_max", &P::d_max, 6.5, 12.0, false},
    {"s_crit", &P::s_crit, 7.0, 20.0, true},
    {"t_crit", &P::t_crit, 3.5, 10.0, true},
}};

/// The share of the range at which a value is.
double share_of(const TunedParameter& range, double value) {
    return range.logarithmic ? std::log(value / range.lowest) / std::log(range.highest / range.lowest)
                             : (value - range.lowest) / (range.highest - range.lowest);
}

/// The value at a share.
double value_at(const TunedParameter& range, double share) {
    return range.logarithmic ? range.lowest * std::pow(range.highest / range.lowest, share)
                             : range.lowest + share * (range.highest - range.lowest);
}

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

constexpr double kGlobalShare = 0.3;
/// Largest distance of the global search from the start on each axis of the unit cube. In the whole cube,
/// nearly every point is worse than a start set by hand: none of 118 evaluations was better.
constexpr double kReach = 0.2;
/// Distance in the unit cube: between closer points, the figures are flat.
constexpr double kFirstStep = 0.08;
constexpr double kMinStep = 1e-3;

/// One fit. Keeps the best point evaluated, whatever an algorithm returns.
class Fit {
  public:
    Fit(const Evaluate& evaluate, const RldParameters& start)
        : evaluate_(evaluate), rest_(start), best_point_(to_unit_cube(start)) {
        best_.parameters = start;
        best_.figure = best_.figure_of_start = evaluate_(start);
    }

    /// Starts from the best point so far and stays within `reach` of it on each axis.
    void run(nlopt::algorithm algorithm, std::size_t evaluations, double reach) {
        if (evaluations == 0) return;
        nlopt::opt search(algorithm, static_cast<unsigned>(best_point_.size()));
        std::vector<double> lower;
        std::vector<double> upper;
        for (const double coordinate : best_point_) {
            lower.push_back(std::max(0.0, coordinate - reach));
            upper.push_back(std::min(1.0, coordinate + reach));
        }
        search.set_lower_bounds(lower);
        search.set_upper_bounds(upper);
        search.set_max_objective(&Fit::value, this);
        search.set_maxeval(static_cast<int>(evaluations));
        search.set_initial_step(kFirstStep);
        search.set_xtol_abs(kMinStep);
        // Fewer random points at first than NLopt's ten for each dimension, which are meant for longer
        // searches.
        if (algorithm == nlopt::GN_CRS2_LM) {
            const std::size_t fewest = best_point_.size() + 1;
            search.set_population(static_cast<unsigned>(std::clamp(evaluations / 4, fewest, 10 * fewest)));
        }
        std::vector<double> point = best_point_;
        double reached = 0.0;
        try {
            search.optimize(point, reached);
        } catch (const nlopt::roundoff_limited&) {
            // The best point is kept.
        } catch (const nlopt::forced_stop&) {
            std::rethrow_exception(failure_);
        }
    }

    [[nodiscard]] const Tuned& best() const { return best_; }

  private:
    static double value(const std::vector<double>& point, std::vector<double>& /*gradient*/, void* self) {
        return static_cast<Fit*>(self)->value(point);
    }
    double value(const std::vector<double>& point) {
        try {
            const RldParameters parameters = from_unit_cube(point, rest_);
            const double figure = evaluate_(parameters);
            if (figure > best_.figure) {
                best_point_ = point;
                best_.parameters = parameters;
                best_.figure = figure;
            }
            return figure;
        } catch (...) {
            failure_ = std::current_exception();  // NLopt passes on only exceptions of its own
            throw nlopt::forced_stop();
        }
    }

    const Evaluate& evaluate_;
    RldParameters rest_;
    std::vector<double> best_point_;
    Tuned best_;
    std::exception_ptr failure_;
};

}  // namespace

double rounded(double value) {
    constexpr double kStepsPerUnit = 1e4;
    return std::round(value * kStepsPerUnit) / kStepsPerUnit;
}

std::span<const TunedParameter> tuned_parameters(const RldParameters& start) {
    const std::span<const TunedParameter> all(kTuned);
    return has_shape_costs(start) ? all.first(kShape + kCosts) : all.last(kCosts + kLimits);
}

std::vector<double> to_unit_cube(const RldParameters& parameters) {
    std::vector<double> point;
    for (const TunedParameter& tuned : tuned_parameters(parameters)) {
        point.push_back(share_of(tuned, std::clamp(parameters.*tuned.value, tuned.lowest, tuned.highest)));
    }
    return point;
}

RldParameters from_unit_cube(std::span<const double> point, const RldParameters& rest) {
    RldParameters parameters = rest;
    for (const TunedParameter& limit : std::span(kTuned).last(kLimits)) {
        parameters.*limit.value = std::clamp(rest.*limit.value, limit.lowest, limit.highest);
    }
    const std::span<const TunedParameter> tuned_ones = tuned_parameters(rest);
    for (std::size_t i = 0; i < tuned_ones.size(); ++i) {
        const TunedParameter& tuned = tuned_ones[i];
        parameters.*tuned.value = std::clamp(rounded(value_at(tuned, point[i])), tuned.lowest, tuned.highest);
    }
    return parameters;
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

Tuned tune(const Evaluate& evaluate, const RldParameters& start, const TunerOptions& options) {
    nlopt::srand(options.seed);
    Fit fit(evaluate, start);
    const auto global = static_cast<std::size_t>(kGlobalShare * static_cast<double>(options.evaluations));
    constexpr double kWholeCube = 1.0;
    fit.run(nlopt::GN_CRS2_LM, global, kReach);
    fit.run(nlopt::LN_SBPLX, options.evaluations - global, kWholeCube);
    return fit.best();
}

}  // namespace conelane::learning
