#include "detectors/planner/lane_choice.hpp"

#include "detectors/planner/lane_stretch.hpp"

#include <algorithm>

namespace conelane {

void LaneChoice::clear() {
    *this = LaneChoice(settings_);
}

void LaneChoice::move_along(const RigidShift& shift) {
    if (challenger_) move(*challenger_, shift);
}

bool LaneChoice::is_spent(const DrivableLane& left) const {
    return left.points.empty() || left.length_m < settings_.min_left_m;
}

bool LaneChoice::agrees(const DrivableLane& lane, const DrivableLane& left) const {
    return is_spent(left) || jump_m(lane, left, settings_.near_m) <= settings_.jump_m;
}

bool LaneChoice::take(const DrivableLane& fresh, const DrivableLane& left, double weight,
                      double kept_weight) {
    if (agrees(fresh, left)) {
        support_ = is_spent(left) ? weight : std::min(settings_.max_support, support_ + weight);
        challenger_.reset();
        return true;
    }
    const bool again = challenger_ && jump_m(fresh, *challenger_, settings_.near_m) <= settings_.jump_m;
    challenger_support_ = again ? challenger_support_ + weight : weight;
    challenger_frames_ = again ? challenger_frames_ + 1 : 1;
    support_ = std::min(settings_.max_support, support_ + kept_weight);
    if (challenger_frames_ >= 2 && challenger_support_ >= support_) {
        support_ = std::min(settings_.max_support, challenger_support_);
        challenger_.reset();
        return true;
    }
    challenger_ = fresh;
    return false;
}

}  // namespace conelane
