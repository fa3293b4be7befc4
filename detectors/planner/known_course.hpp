#pragma once

#include "conelane/drivable_lane.hpp"
#include "conelane/planner.hpp"

#include <string_view>
#include <vector>

namespace conelane {

/// Half of the narrowest lane that the rules allow [m].
inline constexpr double kKnownHalfWidth_m = 1.5;

/// A cone of a course whose shape the rules give.
struct KnownCone {
    Point position{0.0, 0.0};  ///< where the lane is 3 m wide
    Point outward{0.0, 0.0};   ///< unit vector away from the lane: a wider lane has the cone farther along it
    bool certain = true;       ///< false where events differ: that it is not seen says nothing
    ConeColor color = ConeColor::unknown;
};

/// A straight piece of boundary whose cones may stand anywhere along it. It is parallel to the x axis.
struct KnownLine {
    double from_x_m = 0.0;
    double to_x_m = 0.0;
    double y_m = 0.0;        ///< where the lane is 3 m wide
    double outward_y = 1.0;  ///< 1 or -1
};

/// Acceleration or skidpad in course coordinates: x along the lane at the start, y to the left, the origin in
/// the middle of the start line (acceleration) or of the timing line between both circles (skidpad).
///
/// The route is measured by `s`, which is x before the origin. It passes places of the skidpad more than
/// once, so that `s` and not the place tells what comes next.
struct KnownCourse {
    Mission mission = Mission::acceleration;
    std::vector<KnownCone> cones;
    std::vector<KnownLine> lines;
    double start_x_m = 0.0;       ///< of the car at the start
    double finish_s_m = 0.0;      ///< the last line
    double end_s_m = 0.0;         ///< where the car has to be at rest
    double max_ahead_m = 0.0;     ///< of a lane: it does not meet itself within
    double min_widening_m = 0.0;  ///< of the half width, against kKnownHalfWidth_m
    double max_widening_m = 0.0;
    double repeats_every_m = 0.0;  ///< a shift along x that looks nearly the same; 0 where there is none

    /// The route at `s`: position, heading and curvature in course coordinates; no widths.
    [[nodiscard]] DrivablePoint at(double s_m) const;
    /// "approach", "right 1", "right 2", "left 1", "left 2" or "exit"; empty in acceleration.
    [[nodiscard]] std::string_view phase(double s_m) const;
    /// Circles that are complete; 0 in acceleration.
    [[nodiscard]] int laps(double s_m) const;
};

/// Precondition: the mission is acceleration or skidpad.
[[nodiscard]] KnownCourse known_course(Mission mission);

}  // namespace conelane
