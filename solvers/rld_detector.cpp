#include "solvers/rld_detector.hpp"

#include "model/lane_graph_problem.hpp"
#include "model/deadline.hpp"

#include <algorithm>
#include <utility>

namespace conelane {
namespace {

LaneStatus lane_status(SolveStatus status) {
    switch (status) {
        case SolveStatus::optimal:
        case SolveStatus::feasible:
            return LaneStatus::found;
        case SolveStatus::infeasible:
            return LaneStatus::none;
        case SolveStatus::stopped:
            return LaneStatus::stopped;
        case SolveStatus::error:
            break;
    }
    return LaneStatus::error;
}

class RldDetector : public LaneDetector {
  public:
    RldDetector(std::unique_ptr<RldSolver> solver, const RldDetectorOptions& options)
        : solver_(std::move(solver)), options_(options) {}

    LaneAnswer detect(const Scene& scene, const DetectionLimits& limits) override {
        if (!options_.nearest) return solve(scene, limits);
        const std::size_t nearest = *options_.nearest;
        const std::size_t seen = std::max(nearest, options_.context.value_or(nearest));
        LaneAnswer answer = solve(nearest_ahead(scene, seen), limits);
        if (seen > nearest) cut(answer, scene, nearest);
        return answer;
    }

    void reset() override { previous_.reset(); }

  private:
    struct Solution {
        Scene scene;
        LaneGraph graph;
    };

    LaneAnswer solve(const Scene& scene, const DetectionLimits& limits) {
        const Deadline deadline(limits.time_limit_ms);
        const LaneGraphProblem problem = make_problem(scene, options_.parameters, solver_->extent());
        std::optional<LaneGraph> start;
        if (previous_) start = map_by_cone_id(previous_->scene, previous_->graph, scene);
        const RldReport report = solver_->solve(
            problem, {deadline.remaining_ms(), options_.absolute_gap}, start ? &*start : nullptr);
        if (options_.warm_start && report.lane_graph) previous_ = Solution{scene, *report.lane_graph};
        LaneAnswer answer;
        answer.status = lane_status(report.status);
        answer.message = report.message;
        answer.stopped_by = report.stopped_by;
        if (answer.status != LaneStatus::found) return answer;
        std::optional<Lane> lane = report.lane_graph ? to_lane(*report.lane_graph, scene) : std::nullopt;
        if (!lane) {
            answer.status = LaneStatus::error;
            answer.message = "the solver's edges are no lane graph";
            return answer;
        }
        answer.lane = std::move(*lane);
        if (report.objective && report.bound) {
            answer.optimality =
                Optimality{*report.objective, *report.bound, report.status == SolveStatus::optimal};
        }
        return answer;
    }

    static void cut(LaneAnswer& answer, const Scene& scene, std::size_t nearest) {
        if (answer.status != LaneStatus::found) return;
        Lane part = cut_to_nearest(answer.lane, scene, nearest);
        answer.uncut = UncutLane{std::move(answer.lane), answer.optimality};
        answer.optimality.reset();
        answer.lane = std::move(part);
        if (!answer.lane.left.empty() && !answer.lane.right.empty()) return;
        answer.lane = {};
        answer.status = LaneStatus::none;
    }

    std::unique_ptr<RldSolver> solver_;
    RldDetectorOptions options_;
    std::optional<Solution> previous_;  ///< with warm_start only
};

}  // namespace

std::unique_ptr<LaneDetector> make_rld_detector(std::unique_ptr<RldSolver> solver,
                                                const RldDetectorOptions& options) {
    return std::make_unique<RldDetector>(std::move(solver), options);
}

}  // namespace conelane
