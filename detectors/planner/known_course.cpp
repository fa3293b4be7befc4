#include "detectors/planner/known_course.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace conelane {
namespace {

constexpr double kPi = std::numbers::pi;

// Acceleration.
constexpr double kFinish_m = 75.0;
constexpr double kRestWithin_m = 100.0;
constexpr double kSpacing_m = 5.0;
constexpr double kGateHalf_m = 0.3;  ///< the big cones of a gate stand this far before and behind its line

// Skidpad.
constexpr double kRadius_m = 9.125;  ///< of the route, and half the distance of the centres
constexpr double kCircle_m = 2.0 * kPi * kRadius_m;
constexpr double kExit_m = 25.0;
constexpr int kInnerCones = 16;
constexpr std::array<std::string_view, 6> kPhases = {"approach", "right 1", "right 2",
                                                     "left 1",   "left 2",  "exit"};

/// Two cones beside each other at `x`.
void add_pair(KnownCourse& course, double x_m, bool certain, ConeColor left, ConeColor right) {
    course.cones.push_back({{x_m, kKnownHalfWidth_m}, {0.0, 1.0}, certain, left});
    course.cones.push_back({{x_m, -kKnownHalfWidth_m}, {0.0, -1.0}, certain, right});
}

void add_lines(KnownCourse& course, double from_x_m, double to_x_m) {
    course.lines.push_back({from_x_m, to_x_m, kKnownHalfWidth_m, 1.0});
    course.lines.push_back({from_x_m, to_x_m, -kKnownHalfWidth_m, -1.0});
}

KnownCourse acceleration() {
    KnownCourse course;
    course.mission = Mission::acceleration;
    course.start_x_m = -1.0;  // between the 0.3 m of the rules and the 2 m of a simulator
    course.finish_s_m = kFinish_m;
    course.end_s_m = kFinish_m + kRestWithin_m;
    course.max_ahead_m = 60.0;
    course.max_widening_m = 1.25;
    course.repeats_every_m = kSpacing_m;
    const auto gate = [&](double x_m) {
        for (const double half_m : {-kGateHalf_m, kGateHalf_m}) {
            add_pair(course, x_m + half_m, true, ConeColor::orange, ConeColor::orange);
        }
    };
    gate(0.0);
    for (double x_m = kSpacing_m; x_m < kFinish_m - 1.0; x_m += kSpacing_m) {
        add_pair(course, x_m, true, ConeColor::blue, ConeColor::yellow);
    }
    gate(kFinish_m);
    for (double x_m = kFinish_m + kSpacing_m; x_m <= course.end_s_m; x_m += kSpacing_m) {
        add_pair(course, x_m, false, ConeColor::orange, ConeColor::orange);
    }
    add_lines(course, -6.0, course.end_s_m);
    return course;
}

KnownCourse skidpad() {
    KnownCourse course;
    course.mission = Mission::skidpad;
    course.start_x_m = -15.75;  // between the 15 m of the rules and the 16.7 m of recordings
    course.finish_s_m = 4.0 * kCircle_m;
    course.end_s_m = course.finish_s_m + kExit_m;
    course.max_ahead_m = 25.0;
    course.min_widening_m = -0.15;
    course.max_widening_m = 0.35;
    for (const double x_m : {-15.0, -11.25, 11.0, 16.0, 21.0}) {
        add_pair(course, x_m, false, ConeColor::orange, ConeColor::orange);
    }
    add_lines(course, -20.0, -8.5);
    add_lines(course, 8.5, 27.0);
    for (const double side : {-1.0, 1.0}) {  // the right circle, then the left one
        const Point centre(0.0, side * kRadius_m);
        const ConeColor inner = side < 0.0 ? ConeColor::yellow : ConeColor::blue;
        const ConeColor outer = side < 0.0 ? ConeColor::blue : ConeColor::yellow;
        // From the place where the circles touch, so that both mirror each other.
        const auto direction = [&](double angle_rad) {
            return Point(std::sin(angle_rad), -side * std::cos(angle_rad));
        };
        for (int i = 0; i < kInnerCones; ++i) {
            const Point out = direction(2.0 * kPi * i / kInnerCones);
            course.cones.push_back({centre + (kRadius_m - kKnownHalfWidth_m) * out, -out, true, inner});
        }
        // 11 of the 16 places are outside of the lanes between the circles; two more cones stand where the
        // outer circle meets these lanes, or nearer to their neighbor.
        for (int i = 3; i <= kInnerCones - 3; ++i) {
            const Point out = direction(2.0 * kPi * i / kInnerCones);
            course.cones.push_back({centre + (kRadius_m + kKnownHalfWidth_m) * out, out, true, outer});
        }
        for (const double from_middle_rad : {0.79, 1.0}) {
            for (const double angle_rad : {from_middle_rad, -from_middle_rad}) {
                const Point out = direction(angle_rad);
                course.cones.push_back({centre + (kRadius_m + kKnownHalfWidth_m) * out, out, false, outer});
            }
        }
    }
    // The gate of big cones at the timing line; events differ in where it stands.
    for (const double x_m : {-1.2, 1.2}) {
        for (const double side : {1.0, -1.0}) {
            course.cones.push_back({{x_m, side * 1.75}, {0.0, side}, false, ConeColor::orange});
        }
    }
    return course;
}

}  // namespace

KnownCourse known_course(Mission mission) {
    return mission == Mission::skidpad ? skidpad() : acceleration();
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
