#include "detectors/planner/lap_counter.hpp"

#include "detectors/planner/lane_stretch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace conelane {
namespace {

constexpr double kMinSide_m = 1.0;  ///< of an orange cone from the centre line
constexpr double kMaxSide_m = 4.0;
constexpr double kGateDepth_m = 3.0;  ///< along the lane, the cones of one gate
constexpr double kWith_rad = std::numbers::pi / 2.0;

Pose moved(const Pose& pose, const RigidShift& shift) {
    return {shift(pose.position), pose.yaw_rad + shift.turn_rad};
}

}  // namespace

void LapCounter::clear() {
    *this = LapCounter(settings_);
}

void LapCounter::move_along(const RigidShift& shift) {
    if (first_) first_ = moved(*first_, shift);
    if (last_) last_ = moved(*last_, shift);
    line_ = moved(line_, shift);
}

void LapCounter::look_for_gate(const DrivableLane& lane, const ConeMemory& memory) {
    struct Post {
        double s_m;
        bool left;
        bool small;
    };
    std::vector<Post> posts;
    for (const ConeMemory::RememberedCone& cone : memory.cones()) {
        const ConeColor color = color_of(cone);
        if (cone.sightings < 2 || !is_orange(color)) continue;
        if ((cone.position - first_->position).norm() > settings_.gate_within_m) continue;
        std::optional<Post> post;
        double nearest_m = kMaxSide_m;
        for (const DrivablePoint& point : lane.points) {
            const Pose at{point.position, point.heading_rad};
            const double offset_m = (cone.position - point.position).norm();
            if (offset_m >= nearest_m || std::abs(at.ahead_m(cone.position)) > 1.0) continue;
            nearest_m = offset_m;
            if (offset_m >= kMinSide_m)
                post = Post{point.s_m + at.ahead_m(cone.position), at.left_m(cone.position) > 0.0,
                            color == ConeColor::orange};
        }
        if (post) posts.push_back(*post);
    }
    // The first gate ahead that has a post on either side; one of big cones before all others.
    std::ranges::sort(posts, {}, [](const Post& post) { return std::pair(post.small, post.s_m); });
    for (const Post& first : posts) {
        double sum_m = 0.0;
        int left = 0;
        int right = 0;
        for (const Post& post : posts) {
            if (post.s_m < first.s_m || post.s_m > first.s_m + kGateDepth_m) continue;
            sum_m += post.s_m;
            ++(post.left ? left : right);
        }
        if (left == 0 || right == 0) continue;
        const DrivablePoint middle = point_at(lane, sum_m / (left + right));
        line_ = {middle.position, middle.heading_rad};
        gate_ = true;
        return;
    }
}

void LapCounter::observe(const Pose& pose, const DrivableLane& lane, const ConeMemory& memory) {
    if (!first_) {
        first_ = pose;
        line_ = pose;
    }
    if (last_) {
        // Along the heading: the noise of a pose is no way driven.
        const double step_m = pose.heading().dot(pose.position - last_->position);
        driven_m_ += step_m;
        since_line_m_ += step_m;
    }
    if (!gate_ && driven_m_ < settings_.gate_within_m && lane.points.size() > 1) look_for_gate(lane, memory);
    const double ahead_m = line_.ahead_m(pose.position);
    const bool at_line =
        std::abs(line_.left_m(pose.position)) <= settings_.line_half_width_m &&
        std::abs(std::remainder(pose.yaw_rad - line_.yaw_rad, 2.0 * std::numbers::pi)) <= kWith_rad;
    if (last_ && away_ && at_line && ahead_m >= 0.0 && line_.ahead_m(last_->position) < 0.0) {
        ++laps_;
        away_ = false;
        since_line_m_ = ahead_m;
    }
    const bool far = driven_m_ > settings_.gate_within_m &&
                     (pose.position - line_.position).norm() > settings_.line_away_m &&
                     since_line_m_ > settings_.gate_within_m;
    if (far) away_ = true;
    last_ = pose;
}

}  // namespace conelane
