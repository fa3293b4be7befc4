#include "detectors/drivable_answers.hpp"

#include "conelane/drivable_lane.hpp"
#include "conelane/invalid_input.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace conelane {
namespace {

constexpr double kTrustedByRule_m = 10.0;

/// No points where the lane is outside of what `drivable` takes, such as one of more than 20 km.
DrivableLane drivable_or_none(const LaneAnswer& answer, const Scene& scene) {
    try {
        return drivable(answer.lane, scene);
    } catch (const InvalidInput&) {
        return {};
    }
}

double trusted_by_rule_m(const DrivableLane& lane) {
    double trusted_m = std::min(lane.length_m, kTrustedByRule_m);
    for (const BridgedGap& gap : lane.bridged) trusted_m = std::min(trusted_m, std::max(0.0, gap.from_s_m));
    return trusted_m;
}

/// Cuts a boundary that is seen alone before its first gap. Returns whether three cones at least are left,
/// and fewer than there were.
bool cut_at_first_gap(Lane& lane, const Scene& scene) {
    if (lane.left.empty() == lane.right.empty()) return false;
    std::vector<ConeId>& boundary = lane.left.empty() ? lane.right : lane.left;
    const auto at = [&](ConeId id) { return std::ranges::find(scene.cones, id, &Cone::id)->position; };
    const auto gap = std::ranges::adjacent_find(
        boundary, [&, longest_m = DrivableOptions{}.longest_gap_m](ConeId a, ConeId b) {
            return (at(b) - at(a)).norm() > longest_m;
        });
    if (gap == boundary.end()) return false;
    boundary.erase(gap + 1, boundary.end());
    return boundary.size() >= 3;
}

class DrivableAnswers final : public LaneDetector {
  public:
    explicit DrivableAnswers(std::unique_ptr<LaneDetector> detector) : detector_(std::move(detector)) {}
    void reset() override { detector_->reset(); }

  private:
    LaneAnswer search(const Scene& scene, const DetectionLimits& limits) override {
        LaneAnswer answer = detector_->detect(scene, limits);
        if (answer.status != LaneStatus::found) return answer;
        DrivableLane lane = drivable_or_none(answer, scene);
        if (lane.points.empty() && cut_at_first_gap(answer.lane, scene))
            lane = drivable_or_none(answer, scene);
        if (!lane.points.empty()) {
            if (!answer.trusted_m) answer.trusted_m = trusted_by_rule_m(lane);
            return answer;
        }
        LaneAnswer none;
        none.status = LaneStatus::stopped;
        none.stopped_by = answer.stopped_by.value_or(StopReason::iterations);
        none.message = "the lane that was found cannot be driven: it has no centre line from the car on";
        none.enumeration = std::move(answer.enumeration);
        return none;
    }

    std::unique_ptr<LaneDetector> detector_;
};

}  // namespace

std::unique_ptr<LaneDetector> answer_drivable_lanes(std::unique_ptr<LaneDetector> detector) {
    return std::make_unique<DrivableAnswers>(std::move(detector));
}

}  // namespace conelane
