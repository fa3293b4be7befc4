#pragma once

#include "conelane/drivable_lane.hpp"

namespace conelane {

/// The turn from one heading to another, in (-pi, pi].
[[nodiscard]] double turn_rad(double from_rad, double to_rad);

[[nodiscard]] inline Pose pose_of(const DrivablePoint& point) {
    return {point.position, point.heading_rad};
}

/// All of a point but its arc length, curvature and widths linear, on the straight line to another one.
[[nodiscard]] DrivablePoint between(const DrivablePoint& a, const DrivablePoint& b, double share);

/// The place of a car on a lane: the nearest point whose direction is within 90 degrees of the car's heading.
struct LaneFoot {
    double s_m = 0.0;
    double offset_m = 0.0;  ///< distance of the car
};
/// The same in a range of arc lengths; nothing if no point of it runs with the car.
[[nodiscard]] std::optional<LaneFoot> foot_on(const DrivableLane& lane, const Pose& pose, double from_s_m,
                                              double to_s_m);

/// The point at an arc length, interpolated linearly; a closed lane is periodic. Precondition: the lane has a
/// point.
[[nodiscard]] DrivablePoint point_at(const DrivableLane& lane, double s_m);

/// The lane restricted to a range of arc lengths, as an open lane that begins at 0; at most once around a
/// closed lane. No points if the range is shorter than a step.
[[nodiscard]] DrivableLane stretch(const DrivableLane& lane, double from_s_m, double to_s_m, double step_m);

/// Distance of two open lanes within an arc length of the first one, where both exist [m].
[[nodiscard]] double jump_m(const DrivableLane& lane, const DrivableLane& other, double within_m);

/// Arc length of the first lane up to which it is within `apart_m` of the other one; it ends where that one
/// ends. `window_m`: arc length of the other one that is searched past each point.
[[nodiscard]] double common_m(const DrivableLane& lane, const DrivableLane& other, double apart_m,
                              double window_m);

/// Arc length of the first place of a lane beside which a point is, no more than `outside_m` outside the
/// boundaries, or inside them by at least -outside_m; infinite if there is none.
[[nodiscard]] double arc_length_beside(const DrivableLane& lane, const Point& place, double outside_m);

/// Sets the curvatures of an open lane to its turn over 4 m: noise of single points is no bend.
void even_curvatures(DrivableLane& lane);

/// The lane extended back to the car if it begins ahead: along `before`, the lane driven so far, if that
/// leads to it, else in one bend from the car. Nothing if it is more than 12 m away, or, for a bend, too far
/// aside: more than 2.5 m and three tenths of the distance ahead, if it does not turn to that side.
[[nodiscard]] std::optional<DrivableLane> begun_at_car(const DrivableLane& lane, const Pose& pose,
                                                       const DrivableLane* before, double step_m);

/// The lane, extended at its end by `before`, if that continues it smoothly.
[[nodiscard]] DrivableLane extended(const DrivableLane& lane, const DrivableLane& before, double step_m);

/// The lane with its first metres moved halfway towards `before`, the lane driven so far, where both have
/// nearly the same direction: this halves the noise from frame to frame. It stays where they are far apart,
/// and where it would come near a boundary.
[[nodiscard]] DrivableLane steadied(const DrivableLane& lane, const DrivableLane& before, double step_m);

}  // namespace conelane
