#include "detectors/planner/lane_choice.hpp"

#include "detectors/planner/lane_stretch.hpp"

#include <functional>
#include <limits>
#include <utility>

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
    for (double& end_m : trust_ends_m_) end_m = std::max(0.0, end_m - reached_m_);
    reached_m_ = 0.0;
}

void PathMemory::move_along(const RigidShift& shift) {
    if (lane_) move(lane_->points, shift);
}

DrivableLane PathMemory::left(const Pose& pose, double time_s) {
    if (!lane_) return {};
    if (time_s - time_s_ > max_age_s_ + kSameTime_s) {
        lane_.reset();
        trust_ends_m_.fill(0.0);
        why_none_ = "the last lane is too old";
        return {};
    }
    const auto foot = foot_on(*lane_, pose, reached_m_ - kBack_m, reached_m_ + kMaxProgress_m);
    why_none_ = "the car is off the last lane";
    if (!foot || foot->offset_m > settings_.max_offset_m) return {};
    why_none_ = "the last lane is at its end";
    if (foot->s_m > reached_m_) reached_m_ = foot->s_m;
    return stretch(*lane_, foot->s_m, lane_->length_m, step_m_);
}

double PathMemory::steady_trust_m(double trusted_m, double until_m) {
    for (double& end_m : trust_ends_m_) end_m = std::min(end_m, reached_m_ + until_m);
    if (reached_m_ + trusted_m > trust_ends_m_.back()) {
        trust_ends_m_.back() = reached_m_ + trusted_m;
        std::ranges::sort(trust_ends_m_, std::greater());
    }
    return std::max(trusted_m, trust_ends_m_.back() - reached_m_);
}

void LaneChoice::move_along(const RigidShift& shift) {
    if (challenger_) move(challenger_->points, shift);
    for (Supported& point : driven_) point.place = shift(point.place);
}

bool LaneChoice::is_spent(const DrivableLane& left) const {
    return left.points.empty() || left.length_m < settings_.min_left_m;
}

bool LaneChoice::agrees(const DrivableLane& lane, const DrivableLane& left) const {
    return is_spent(left) || jump_m(lane, left, settings_.near_m) <= settings_.jump_m;
}

/// Where the lane runs along the one driven so far, `weight` is added to what supported that one; elsewhere
/// it is the only support.
void LaneChoice::support(const DrivableLane& lane, double weight) {
    std::vector<Supported> next;
    next.reserve(lane.points.size());
    std::size_t at = 0;  // both are followed from the car on: another leg may be nearer
    for (const DrivablePoint& point : lane.points) {
        double nearest_m2 = settings_.jump_m * settings_.jump_m;
        std::optional<std::size_t> nearest;
        for (std::size_t i = at; i < driven_.size(); ++i) {
            const double distance_m2 = (driven_[i].place - point.position).squaredNorm();
            if (distance_m2 > nearest_m2) continue;
            nearest_m2 = distance_m2;
            nearest = i;
        }
        if (nearest) at = *nearest;
        const double before = nearest ? driven_[*nearest].weight : 0.0;
        next.push_back({point.position, std::min(settings_.max_support, before + weight)});
    }
    driven_ = std::move(next);
}

double LaneChoice::support_where_left(const DrivableLane& fresh, const DrivableLane& left) const {
    const double shared_m = common_m(fresh, left, settings_.jump_m, settings_.near_m);
    // A little past it: places next to each other share their support.
    const Point place = point_at(left, shared_m + settings_.jump_m).position;
    double nearest_m2 = std::numeric_limits<double>::infinity();
    double weight = 0.0;
    for (const Supported& point : driven_) {
        const double distance_m2 = (point.place - place).squaredNorm();
        if (distance_m2 >= nearest_m2) continue;
        nearest_m2 = distance_m2;
        weight = point.weight;
    }
    return weight;
}

bool LaneChoice::take(const DrivableLane& fresh, const DrivableLane& left, double weight,
                      double kept_weight) {
    if (agrees(fresh, left)) {
        if (is_spent(left)) driven_.clear();
        support(fresh, weight);
        challenger_.reset();
        return true;
    }
    const bool again = challenger_ && jump_m(fresh, *challenger_, settings_.near_m) <= settings_.jump_m;
    challenger_support_ = again ? challenger_support_ + weight : weight;
    challenger_frames_ = again ? challenger_frames_ + 1 : 1;
    for (Supported& point : driven_) {
        point.weight = std::min(settings_.max_support, point.weight + kept_weight);
    }
    if (challenger_frames_ >= 2 && challenger_support_ >= support_where_left(fresh, left)) {
        support(fresh, 0.0);
        const double least = std::min(settings_.max_support, challenger_support_);
        for (Supported& point : driven_) point.weight = std::max(point.weight, least);
        challenger_.reset();
        return true;
    }
    challenger_ = fresh;
    return false;
}

}  // namespace conelane
