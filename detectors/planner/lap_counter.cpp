#include "detectors/planner/lap_counter.hpp"

#include "detectors/planner/lane_stretch.hpp"

namespace conelane {
namespace {

constexpr double kMinSide_m = 1.0;  ///< of an orange cone from the centre line
constexpr double kMaxSide_m = 4.0;
constexpr double kGateDepth_m = 3.0;  ///< along the lane, the cones of one gate
constexpr double kEndInView_m = 5.0;  ///< before a gate: from here the cones behind it are in view
constexpr double kWith_rad = std::numbers::pi / 2.0;

Pose moved(const Pose& pose, const RigidShift& shift) {
    return {shift(pose.position), pose.yaw_rad + shift.turn_rad};
}

}  // namespace

void LapCounter::move_along(const RigidShift& shift) {
    for (std::optional<Pose>* pose : {&first_, &last_, &finish_}) {
        if (*pose) **pose = moved(**pose, shift);
    }
    line_ = moved(line_, shift);
}

std::optional<Pose> LapCounter::gate_on(const DrivableLane& lane, const ConeMemory& memory,
                                        bool near_start) const {
    struct Post {
        double s_m;
        bool left;
        bool small;
    };
    std::vector<Post> posts;
    for (const ConeMemory::RememberedCone& cone : memory.cones()) {
        const ConeColor color = color_of(cone);
        if (cone.sightings < 2 || !is_orange(color)) continue;
        const Point& start = near_start ? first_->position : line_.position;
        if (((cone.position - start).norm() <= settings_.gate_within_m) != near_start) continue;
        std::optional<Post> post;
        double nearest_m = kMaxSide_m;
        for (const DrivablePoint& point : lane.points) {
            const Pose at = pose_of(point);
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
        return pose_of(point_at(lane, sum_m / (left + right)));
    }
    return std::nullopt;
}

bool LapCounter::crosses(const Pose& line, const Pose& pose) const {
    return last_ && line.ahead_m(last_->position) < 0.0 && line.ahead_m(pose.position) >= 0.0 &&
           std::abs(line.left_m(pose.position)) <= settings_.line_half_width_m &&
           std::abs(turn_rad(line.yaw_rad, pose.yaw_rad)) <= kWith_rad;
}

std::optional<double> LapCounter::to_stop_line_m(const DrivableLane& lane) const {
    const bool is_at_end = finish_ && course_ends_ && !passed_finish_;
    if (laps_ >= laps_of_run_ || (!is_at_end && (laps_ + 1 < laps_of_run_ || !away_))) return std::nullopt;
    const auto foot = foot_on(lane, is_at_end ? *finish_ : line_, 0.0, lane.length_m);
    const bool is_on = foot && foot->s_m > 0.0 && foot->s_m < lane.points.back().s_m;
    return is_on && foot->offset_m <= settings_.line_half_width_m ? std::optional(foot->s_m) : std::nullopt;
}

bool LapCounter::nothing_ahead(const Pose& place, const ConeMemory& memory) {
    constexpr double kAhead_m = 15.0;
    constexpr double kAside_m = 8.0;
    return std::ranges::none_of(memory.cones(), [&](const ConeMemory::RememberedCone& cone) {
        const double ahead_m = place.ahead_m(cone.position);
        return !is_orange(color_of(cone)) && ahead_m > 1.0 && ahead_m < kAhead_m &&
               std::abs(place.left_m(cone.position)) < kAside_m;
    });
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
    const bool at_start = driven_m_ < settings_.gate_within_m;
    if (lane.points.size() > 1 && (at_start ? !gate_ : laps_of_run_ == 1 && !passed_finish_)) {
        if (const std::optional<Pose> gate = gate_on(lane, memory, at_start)) {
            (at_start ? line_ : finish_.emplace()) = *gate;
            gate_ = gate_ || at_start;
        }
    }
    if (finish_ && crosses(*finish_, pose)) {
        passed_finish_ = true;
        since_line_m_ = finish_->ahead_m(pose.position);
    }
    const bool in_view = finish_ && finish_->ahead_m(pose.position) > -kEndInView_m;
    course_ends_ = in_view && nothing_ahead(passed_finish_ ? pose : *finish_, memory);
    if (laps_ == 0 && passed_finish_ && course_ends_) ++laps_;
    if (away_ && crosses(line_, pose)) {
        ++laps_;
        away_ = false;
        since_line_m_ = line_.ahead_m(pose.position);
    }
    const bool far = driven_m_ > settings_.gate_within_m &&
                     (pose.position - line_.position).norm() > settings_.line_away_m &&
                     since_line_m_ > settings_.gate_within_m;
    if (far) away_ = true;
    last_ = pose;
}

}  // namespace conelane
