#include "detectors/drivable/drivable_answers.hpp"

#include "conelane/invalid_input.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

namespace conelane {
namespace {

constexpr double kTrustedByRule_m = 10.0;
/// Time that checking a found lane may still take after the limit.
constexpr double kMinTime_ms = 0.5;
/// Of the limit, what is left for checking, so that a search that takes all of its time loses no lane.
constexpr double kCheckShare = 0.04;
constexpr double kMaxCheck_ms = 2.0;

/// No points if the lane is outside of what `drivable` accepts, such as one of more than 20 km. Nothing if
/// the deadline passes.
std::optional<DrivableLane> drivable_or_none(const LaneAnswer& answer, const Scene& scene,
                                             const Deadline& deadline) {
    try {
        return drivable_within(answer.lane, scene, {}, deadline);
    } catch (const InvalidInput&) {
        return DrivableLane{};
    }
}

double trusted_by_rule_m(const DrivableLane& lane) {
    double trusted_m = std::min(lane.length_m, kTrustedByRule_m);
    for (const BridgedGap& gap : lane.bridged) trusted_m = std::min(trusted_m, std::max(0.0, gap.from_s_m));
    return trusted_m;
}

/// Cuts a boundary that is seen alone before its first gap. Returns whether at least three cones are left,
/// and fewer than before.
bool cut_at_first_gap(Lane& lane, const Scene& scene) {
    if (lane.left.empty() == lane.right.empty()) return false;
    std::vector<ConeId>& boundary = lane.left.empty() ? lane.right : lane.left;
    const auto at = [&](ConeId id) { return std::ranges::find(scene.cones, id, &Cone::id)->position; };
    const auto gap = std::ranges::adjacent_find(
        boundary, [&, max_length_m = DrivableOptions{}.max_gap_m](ConeId a, ConeId b) {
            return (at(b) - at(a)).norm() > max_length_m;
        });
    if (gap == boundary.end()) return false;
    boundary.erase(gap + 1, boundary.end());
    return boundary.size() >= 3;
}

class DrivableAnswers final : public LaneDetector {
  public:
    explicit DrivableAnswers(std::unique_ptr<LaneDetector> detector)
        : LaneDetector(detector->doubled_cone_m()), detector_(std::move(detector)) {}
    void reset() override { detector_->reset(); }

  private:
    LaneAnswer search(const Scene& scene, const DetectionLimits& limits) override {
        const Deadline whole(limits.time_limit_ms);
        DetectionLimits of_search = limits;
        of_search.time_limit_ms -= std::clamp(kCheckShare * limits.time_limit_ms, 0.0, kMaxCheck_ms);
        LaneAnswer answer = search_by(*detector_, scene, of_search);
        if (answer.status != LaneStatus::found) return answer;
        const Deadline deadline(std::max(whole.remaining_ms(), kMinTime_ms));
        std::optional<DrivableLane> lane = drivable_or_none(answer, scene, deadline);
        if (lane && lane->points.empty() && cut_at_first_gap(answer.lane, scene))
            lane = drivable_or_none(answer, scene, deadline);
        if (lane && !lane->points.empty()) {
            if (!answer.trusted_m) answer.trusted_m = trusted_by_rule_m(*lane);
            return answer;
        }
        LaneAnswer none;
        none.status = LaneStatus::stopped;
        if (lane) {
            none.stopped_by = answer.stopped_by.value_or(StopReason::iterations);
            none.message = "the lane that was found cannot be driven: it has no centre line from the car on";
        } else {
            none.stopped_by = StopReason::time;
            none.message = "time was over before it was known whether the lane that was found can be driven";
        }
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
