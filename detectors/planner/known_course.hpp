#pragma once

#include "conelane/planner.hpp"

namespace conelane {

/// Half of the narrowest lane that the rules allow [m].
inline constexpr double kKnownHalfWidth_m = 1.5;

/// A straight piece of boundary, parallel to the x axis. Its cones may be anywhere along it.
struct KnownLine {
    double from_x_m = 0.0;
    double to_x_m = 0.0;
    double y_m = 0.0;        ///< if the lane is 3 m wide
    double outward_y = 1.0;  ///< 1 or -1: direction in which it moves in a wider lane
    ConeColor color = ConeColor::unknown;
};

/// A boundary on a circle, without the part inside another lane. Its cones may be anywhere along it.
struct KnownArc {
    Point centre{0.0, 0.0};
    double radius_m = 0.0;      ///< if the lane is 3 m wide
    double outward = 1.0;       ///< 1: a wider lane has a larger circle; -1: a smaller one
    double side = 1.0;          ///< 1: it is at positive y; -1: at negative y
    double min_aside_m = -1e9;  ///< the boundary is where side * y is at least this
    ConeColor color = ConeColor::unknown;
};

/// A place on a boundary that has a cone within `reach_m`, unless cones are missing.
struct KnownPlace {
    Point position{0.0, 0.0};  ///< if the lane is 3 m wide
    Point outward{0.0, 0.0};   ///< unit vector away from the lane
    double reach_m = 0.0;
};

/// A point relative to the nearest boundary.
struct BoundaryContact {
    Point normal{0.0, 0.0};  ///< unit vector across the boundary
    double off_m = 0.0;      ///< distance of the point along the normal
    double outward = 1.0;    ///< how far the boundary moves along the normal if the lane widens by a meter
    ConeColor color = ConeColor::unknown;
};

/// Acceleration or skidpad in course coordinates: x along the lane at the start, y to the left, the origin in
/// the middle of the start line (acceleration) or of the timing line between the two circles (skidpad).
///
/// The route is measured by `s`, which is x before the origin. It passes some places of the skidpad more than
/// once, so `s`, not the place, determines what comes next.
struct KnownCourse {
    Mission mission = Mission::acceleration;
    std::vector<KnownLine> lines;
    std::vector<KnownArc> arcs;
    std::vector<KnownPlace> places;
    bool has_place_along = false;  ///< the boundaries determine the position along x
    double start_x_m = 0.0;        ///< x of the car at the start
    double finish_s_m = 0.0;       ///< the last line
    double end_s_m = 0.0;          ///< where the car has to be at rest
    double max_ahead_m = 0.0;      ///< largest length of a lane: up to it, the lane does not meet itself
    double min_widening_m = 0.0;   ///< smallest change of the half width, relative to kKnownHalfWidth_m
    double max_widening_m = 0.0;

    /// The nearest boundary within `window_m` of a place, if any.
    [[nodiscard]] std::optional<BoundaryContact> boundary_at(const Point& place, double widening_m,
                                                             double window_m) const;
    /// The route at `s`: position, heading and curvature in course coordinates; no widths.
    [[nodiscard]] DrivablePoint at(double s_m) const;
    /// "approach", "right 1", "right 2", "left 1", "left 2" or "exit"; empty in acceleration.
    [[nodiscard]] std::string_view phase(double s_m) const;
    /// Number of completed circles; 0 in acceleration.
    [[nodiscard]] int laps(double s_m) const;
};

/// Precondition: the mission is acceleration or skidpad.
[[nodiscard]] KnownCourse known_course(Mission mission);

}  // namespace conelane
