#include "detectors/planner/lane_choice.hpp"

#include "detectors/planner/lane_stretch.hpp"

#include <algorithm>

namespace conelane {

void LaneChoice::clear() {
    support_ = 0.0;
    challenger_.reset();
    challenger_support_ = 0.0;
}

void LaneChoice::move_along(const RigidShift& shift) {
    if (challenger_) move(*challenger_, shift);
}

bool LaneChoice::take(const DrivableLane& fresh, const DrivableLane& left) {
    const bool held_by_nothing = left.points.empty() || left.length_m < settings_.min_left_m;
    if (held_by_nothing || jump_m(fresh, left, settings_.near_m) <= settings_.jump_m) {
        support_ = held_by_nothing ? 1.0 : std::min(settings_.max_support, support_ + 1.0);
        challenger_.reset();
        return true;
    }
    const bool again = challenger_ && jump_m(fresh, *challenger_, settings_.near_m) <= settings_.jump_m;
    challenger_support_ = again ? challenger_support_ + 1.0 : 1.0;
    if (challenger_support_ >= std::max(2.0, support_)) {
        support_ = challenger_support_;
        challenger_.reset();
        return true;
    }
    challenger_ = fresh;
    return false;
}

}  // namespace conelane
