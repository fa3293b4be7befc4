#include "detectors/strip_detector.hpp"

#include "detectors/lane_status.hpp"
#include "model/deadline.hpp"

namespace conelane {
namespace {

/// Lanes beside the answer, and how much their search may cost: with more, confidences hardly change.
constexpr std::size_t kLanes = 12;
constexpr std::size_t kLabelsOfOthers = 2'000;
/// The lanes that agree are that likely where the answer is trusted.
constexpr double kLeastTrust = 0.95;
constexpr double kUsable_m = 20.0;

/// How many cones of a boundary another one follows, from the first cone that both have on. One of them may
/// begin earlier.
std::size_t in_common(const std::vector<std::size_t>& a, const std::vector<std::size_t>& b) {
    auto at_a = a.begin();
    auto at_b = std::ranges::find(b, a.front());
    if (at_b == b.end()) {
        at_b = b.begin();
        at_a = std::ranges::find(a, b.front());
        if (at_a == a.end()) return 0;
    }
    return static_cast<std::size_t>(std::mismatch(at_a, a.end(), at_b, b.end()).first - a.begin());
}

class StripDetector : public LaneDetector {
  public:
    explicit StripDetector(StripParameters parameters) : parameters_(std::move(parameters)) {}

  private:
    LaneAnswer search(const Scene& scene, const DetectionLimits& limits) override {
        const Deadline deadline(limits.time_limit_ms);
        LaneAnswer answer;
        const LimitedStripProblem made = make_strip_problem(scene, parameters_, deadline);
        answer.stopped_by = made.stopped_by;
        if (!made.problem) return answer;
        const StripReport report = solver_.solve(*made.problem, {.limits = {deadline.remaining_ms()},
                                                                 .lanes = kLanes,
                                                                 .labels_of_others = kLabelsOfOthers,
                                                                 .worst_of_lanes = 10.0 * kStripTemperature});
        answer.status = lane_status(report.status);
        answer.message = report.message;
        answer.stopped_by = report.stopped_by;
        if (answer.status != LaneStatus::found) return answer;
        for (const std::size_t cone : report.lanes.front().left)
            answer.lane.left.push_back(scene.cones[cone].id);
        for (const std::size_t cone : report.lanes.front().right)
            answer.lane.right.push_back(scene.cones[cone].id);
        answer.optimality = {*report.objective, *report.bound, report.status == SolveStatus::optimal};
        const StripTrust trust = strip_trust(*made.problem, scene, report.lanes);
        answer.confidence = trust.confidence;
        answer.trusted_m = trust.trusted_m;
        return answer;
    }

    StripParameters parameters_;
    StripSolver solver_;
};

}  // namespace

StripTrust strip_trust(const StripProblem& problem, const Scene& scene, std::span<const StripLane> lanes) {
    struct Other {
        double share;      ///< of all lanes
        std::size_t left;  ///< cones in common from the start on
        std::size_t right;
    };
    const StripLane& answer = lanes.front();
    const StripOfLane strip = cheapest_strip(problem, answer).value();
    std::vector<Other> others;
    double sum = 0.0;
    for (const StripLane& lane : lanes) {
        const double over = cheapest_strip(problem, lane).value().cost - strip.cost;
        others.push_back({std::exp(-over / kStripTemperature), in_common(answer.left, lane.left),
                          in_common(answer.right, lane.right)});
        sum += others.back().share;
    }
    StripTrust trust{.confidence = 1.0 / sum};
    double length_m = 0.0;
    std::size_t left = 1;
    std::size_t right = 1;
    for (const std::size_t k : strip.triangles) {
        const StripTriangle& t = problem.triangles[k];
        const bool was_short = length_m < kUsable_m;
        length_m += 0.5 * (scene.cones[problem.entered(t)].position -
                           scene.cones[problem.rungs[t.from].of(t.is_left)].position)
                              .norm();
        ++(t.is_left ? left : right);
        double agree = 0.0;
        for (const Other& other : others)
            agree += other.left >= left && other.right >= right ? other.share / sum : 0.0;
        agree = std::min(1.0, agree);
        if (agree >= kLeastTrust) trust.trusted_m = length_m;
        if (was_short && length_m >= kUsable_m) trust.confidence = agree;
    }
    return trust;
}

std::unique_ptr<LaneDetector> make_strip_detector(StripParameters parameters) {
    return std::make_unique<StripDetector>(std::move(parameters));
}

}  // namespace conelane
