#include "conelane/rld_detector.hpp"

#include "conelane/solve_scene.hpp"
#include "detectors/lane_status.hpp"
#include "model/deadline.hpp"
#include "model/valid_scene_problem.hpp"

#include <exception>
#include <new>

namespace conelane {
namespace {

using MakeProblem = LimitedProblem (*)(const Scene&, const RldParameters&, EdgeExtent, const Deadline&);

SolvedScene solve(RldSolver& solver, const Scene& scene, const RldParameters& parameters,
                  SolveArguments arguments, MakeProblem make_problem_of) {
    const Stopwatch watch;
    const Deadline deadline(arguments.limits.time_limit_ms);
    SolvedScene solved;
    try {
        LimitedProblem made = make_problem_of(scene, parameters, solver.extent(), deadline);
        const double problem_ms = watch.elapsed_ms();
        if (made.problem) {
            solved.problem = *std::move(made.problem);
            arguments.limits.time_limit_ms = deadline.remaining_ms();
            solved.report = solver.solve(solved.problem, arguments);
        } else {
            solved.report.status = SolveStatus::stopped;
            solved.report.stopped_by = made.stopped_by;
        }
        solved.report.build_ms += problem_ms;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& failure) {
        solved.report = {};
        solved.report.message = failure.what();
    }
    solved.total_ms = watch.elapsed_ms();
    return solved;
}

class RldDetector : public LaneDetector {
  public:
    RldDetector(std::unique_ptr<RldSolver> solver, RldDetectorOptions options)
        : solver_(std::move(solver)), options_(std::move(options)) {}

    void reset() override { previous_.reset(); }

  private:
    struct Solution {
        Scene scene;
        LaneGraph graph;
    };

    LaneAnswer search(const Scene& scene, const DetectionLimits& limits) override {
        const Deadline deadline(limits.time_limit_ms);
        const ConeSet& cones = options_.cones;
        if (!cones.nearest) return solve_by_any_d_near(scene, deadline);
        LaneAnswer answer = solve_by_any_d_near(cones.seen(scene), deadline);
        if (!cones.has_context() || answer.status != LaneStatus::found) return answer;
        Lane part = cut_to_nearest(answer.lane, scene, *cones.nearest, options_.parameters.d_max);
        if (part.left.empty() || part.right.empty()) {
            return solve_by_any_d_near(nearest_ahead(scene, *cones.nearest), deadline);
        }
        if (part == answer.lane) return answer;
        if (!answer.solved) answer.solved.emplace();
        answer.solved->lane = std::move(answer.lane);
        answer.solved->optimality = std::exchange(answer.optimality, {});
        answer.lane = std::move(part);
        return answer;
    }

    LaneAnswer solve_by_any_d_near(const Scene& seen, const Deadline& deadline) {
        LaneAnswer answer = solve(seen, options_.parameters, deadline.remaining_ms());
        for (const double d_near_m : options_.other_d_near_m) {
            if (answer.status != LaneStatus::none) break;
            RldParameters other = options_.parameters;
            other.d_near = d_near_m;
            answer = solve(seen, other, deadline.remaining_ms());
            if (answer.status != LaneStatus::found) continue;
            answer.optimality.reset();
            answer.solved = SolvedLane{.lane = answer.lane, .d_near_m = d_near_m};
            answer.message =
                "by another d_near, because no lane graph is feasible with that of the parameters";
        }
        return answer;
    }

    LaneAnswer solve(const Scene& seen, const RldParameters& parameters, double time_limit_ms) {
        std::optional<LaneGraph> start;
        if (previous_) start = map_by_cone_id(previous_->scene, previous_->graph, seen);
        // The scene has been validated already.
        const RldReport report = conelane::solve(*solver_, seen, parameters,
                                                 {.limits = {time_limit_ms, options_.absolute_gap},
                                                  .start = start ? &*start : nullptr},
                                                 make_problem_of_valid_scene)
                                     .report;
        if (options_.warm_start && report.lane_graph) previous_ = Solution{seen, *report.lane_graph};
        LaneAnswer answer;
        // A backend that fails keeps a feasible start: a lane without a statement about its optimality.
        answer.status = report.lane_graph ? LaneStatus::found : lane_status(report.status);
        answer.message = report.message;
        answer.stopped_by = report.stopped_by;
        if (answer.status != LaneStatus::found) return answer;
        std::optional<Lane> lane = report.lane_graph ? to_lane(*report.lane_graph, seen) : std::nullopt;
        if (!lane) {
            answer.status = LaneStatus::error;
            answer.message = "the solver's edges are not a lane graph";
            return answer;
        }
        answer.lane = std::move(*lane);
        if (report.objective && report.bound) {
            answer.optimality =
                Optimality{*report.objective, *report.bound, report.status == SolveStatus::optimal};
        }
        return answer;
    }

    std::unique_ptr<RldSolver> solver_;
    RldDetectorOptions options_;
    std::optional<Solution> previous_;  ///< with warm_start only
};

}  // namespace

SolvedScene solve_scene(RldSolver& solver, const Scene& scene, const RldParameters& parameters,
                        const SolveArguments& arguments) {
    return solve(solver, scene, parameters, arguments, make_problem);
}

bool ConeSet::has_context() const {
    return nearest && context > nearest;
}

Scene ConeSet::seen(const Scene& scene) const {
    return nearest ? nearest_ahead(scene, std::max(*nearest, context.value_or(0))) : scene;
}

std::unique_ptr<LaneDetector> make_rld_detector(std::unique_ptr<RldSolver> solver,
                                                const RldDetectorOptions& options) {
    return std::make_unique<RldDetector>(std::move(solver), options);
}

}  // namespace conelane
