#include "detectors/planner/path_memory.hpp"

#include "detectors/planner/lane_stretch.hpp"

namespace conelane {
namespace {

/// Farther than this the car does not come from one frame to the next; another leg may be nearer [m].
constexpr double kMaxProgress_m = 5.0;
/// It may be a little back: the pose is not exact [m].
constexpr double kBack_m = 1.0;
/// Times that differ by less are one time [s].
constexpr double kSameTime_s = 1e-9;

}  // namespace

void PathMemory::remember(const DrivableLane& lane, double time_s) {
    lane_ = lane;
    time_s_ = time_s;
    reached_m_ = 0.0;
}

void PathMemory::move_along(const RigidShift& shift) {
    if (lane_) move(*lane_, shift);
}

DrivableLane PathMemory::left(const Pose& pose, double time_s) {
    if (!lane_) return {};
    if (time_s - time_s_ > max_age_s_ + kSameTime_s) {
        lane_.reset();
        return {};
    }
    const auto foot = foot_on(*lane_, pose, reached_m_ - kBack_m, reached_m_ + kMaxProgress_m);
    if (!foot || foot->offset_m > settings_.max_offset_m) return {};
    if (foot->s_m > reached_m_) reached_m_ = foot->s_m;
    return stretch(*lane_, foot->s_m, lane_->length_m, step_m_);
}

}  // namespace conelane
