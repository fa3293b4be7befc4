#include "detectors/planner/known_course.hpp"

#include <array>

namespace conelane {
namespace {

constexpr double kPi = std::numbers::pi;

// Acceleration.
constexpr double kFinish_m = 75.0;
constexpr double kRestWithin_m = 100.0;
constexpr double kBeforeStart_m = 6.0;
constexpr double kSpacing_m = 5.0;       ///< of cones, more or less
constexpr double kSpacingReach_m = 3.2;  ///< a place without a cone within it lacks one

// Skidpad.
constexpr double kRadius_m = 9.125;  ///< of the route, and half the distance of the centres
constexpr double kCircle_m = 2.0 * kPi * kRadius_m;
constexpr double kExit_m = 25.0;
constexpr double kEntryFrom_m = -20.0;
constexpr double kExitTo_m = 27.0;
constexpr double kJunction_m = 7.4;  ///< where the outer circle meets the lanes of entry and exit
constexpr int kInnerCones = 16;
constexpr double kRingReach_m = 1.9;
constexpr double kOtherLane_m = 1.3;  ///< nearer to the x axis the outer circle lies in another lane
constexpr std::array<std::string_view, 6> kPhases = {"approach", "right 1", "right 2",
                                                     "left 1",   "left 2",  "exit"};

/// Both boundaries of a lane along the x axis.
void add_lines(KnownCourse& course, double from_x_m, double to_x_m, ConeColor left, ConeColor right) {
    for (const double side : {1.0, -1.0}) {
        course.lines.push_back({.from_x_m = from_x_m,
                                .to_x_m = to_x_m,
                                .y_m = side * kKnownHalfWidth_m,
                                .outward_y = side,
                                .color = side > 0.0 ? left : right});
    }
}

KnownCourse acceleration() {
    KnownCourse course;
    course.mission = Mission::acceleration;
    course.start_x_m = -1.5;  // between the 0.3 m of the rules and the 2 m of a simulator
    course.finish_s_m = kFinish_m;
    course.end_s_m = kFinish_m + kRestWithin_m;
    course.max_ahead_m = 60.0;
    course.min_widening_m = -0.1;
    course.max_widening_m = 1.4;
    add_lines(course, -kBeforeStart_m, kFinish_m - 1.0, ConeColor::blue, ConeColor::yellow);
    add_lines(course, kFinish_m - 1.0, course.end_s_m, ConeColor::orange, ConeColor::orange);
    for (double x_m = 0.0; x_m <= kFinish_m; x_m += kSpacing_m) {
        course.places.push_back({{x_m, kKnownHalfWidth_m}, {0.0, 1.0}, kSpacingReach_m});
        course.places.push_back({{x_m, -kKnownHalfWidth_m}, {0.0, -1.0}, kSpacingReach_m});
    }
    return course;
}

KnownCourse skidpad() {
    KnownCourse course;
    course.mission = Mission::skidpad;
    course.has_place_along = true;
    course.start_x_m = -15.75;  // between the 15 m of the rules and the 16.7 m of recordings
    course.finish_s_m = 4.0 * kCircle_m;
    course.end_s_m = course.finish_s_m + kExit_m;
    course.max_ahead_m = 25.0;
    course.min_widening_m = -0.15;
    course.max_widening_m = 0.35;
    add_lines(course, kEntryFrom_m, -kJunction_m, ConeColor::orange, ConeColor::orange);
    add_lines(course, kJunction_m, kExitTo_m, ConeColor::orange, ConeColor::orange);
    for (const double side : {-1.0, 1.0}) {  // the right circle, then the left one
        const Point centre(0.0, side * kRadius_m);
        const ConeColor inner = side < 0.0 ? ConeColor::yellow : ConeColor::blue;
        const ConeColor outer = side < 0.0 ? ConeColor::blue : ConeColor::yellow;
        const double inner_m = kRadius_m - kKnownHalfWidth_m;
        for (const double outward : {-1.0, 1.0}) {
            course.arcs.push_back({.centre = centre,
                                   .radius_m = kRadius_m + outward * kKnownHalfWidth_m,
                                   .outward = outward,
                                   .side = side,
                                   .min_aside_m = outward < 0.0 ? 0.0 : kOtherLane_m,
                                   .color = outward < 0.0 ? inner : outer});
        }
        for (int i = 0; i < kInnerCones; ++i) {
            const double angle_rad = 2.0 * kPi * i / kInnerCones;
            const Point out(std::sin(angle_rad), -side * std::cos(angle_rad));
            course.places.push_back({centre + inner_m * out, -out, kRingReach_m});
        }
    }
    return course;
}

}  // namespace

KnownCourse known_course(Mission mission) {
    return mission == Mission::skidpad ? skidpad() : acceleration();
}

std::optional<BoundaryContact> KnownCourse::boundary_at(const Point& place, double widening_m,
                                                        double window_m) const {
    std::optional<BoundaryContact> nearest;
    double nearest_m = window_m;
    for (const KnownLine& line : lines) {
        if (place.x() < line.from_x_m || place.x() > line.to_x_m) continue;
        const double off_m = place.y() - line.y_m - widening_m * line.outward_y;
        if (std::abs(off_m) >= nearest_m) continue;
        nearest_m = std::abs(off_m);
        nearest = BoundaryContact{{0.0, 1.0}, off_m, line.outward_y, line.color};
    }
    for (const KnownArc& arc : arcs) {
        if (arc.side * place.y() < arc.min_aside_m) continue;
        const Point arm = place - arc.centre;
        const double distance_m = arm.norm();
        const double off_m = distance_m - arc.radius_m - widening_m * arc.outward;
        if (std::abs(off_m) >= nearest_m || distance_m == 0.0) continue;
        nearest_m = std::abs(off_m);
        nearest = BoundaryContact{arm / distance_m, off_m, arc.outward, arc.color};
    }
    return nearest;
}

DrivablePoint KnownCourse::at(double s_m) const {
    DrivablePoint point;
    point.s_m = s_m;
    if (mission == Mission::acceleration || s_m < 0.0) {
        point.position = Point(s_m, 0.0);
        return point;
    }
    if (s_m >= finish_s_m) {
        point.position = Point(s_m - finish_s_m, 0.0);
        return point;
    }
    const double side = s_m < 2.0 * kCircle_m ? -1.0 : 1.0;
    const double angle_rad = std::fmod(s_m, kCircle_m) / kRadius_m;
    point.position = Point(kRadius_m * std::sin(angle_rad), side * kRadius_m * (1.0 - std::cos(angle_rad)));
    point.heading_rad = std::remainder(side * angle_rad, 2.0 * kPi);
    point.curvature_1pm = side / kRadius_m;
    return point;
}

int KnownCourse::laps(double s_m) const {
    if (mission != Mission::skidpad) return 0;
    return std::clamp(static_cast<int>(std::floor(s_m / kCircle_m)), 0, 4);
}

std::string_view KnownCourse::phase(double s_m) const {
    if (mission != Mission::skidpad) return {};
    return s_m < 0.0 ? kPhases[0] : kPhases[static_cast<std::size_t>(laps(s_m)) + 1];
}

}  // namespace conelane
