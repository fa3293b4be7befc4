#pragma once

#include "experiments/race/course.hpp"

#include <functional>
#include <random>

namespace conelane::tests {

/// A course and the middle of its lane: what a planner should find, and where its car drives.
struct DrivenCourse {
    Mission mission = Mission::trackdrive;
    std::vector<Cone> cones;           ///< ids from 0, true colors
    std::function<Pose(double)> pose;  ///< of the car after so many metres from the start
    double finish_m = 0.0;             ///< where the last line is crossed
    double lap_m = 0.0;                ///< once around; 0 if the course does not come round
};

inline Pose between(const Pose& a, const Pose& b, double share) {
    const double turn_rad = std::remainder(b.yaw_rad - a.yaw_rad, 2.0 * std::numbers::pi);
    return {a.position + share * (b.position - a.position), a.yaw_rad + share * turn_rad};
}

/// Two straights of 20 m joined by half circles of 8 m, driven to the left, 3.5 m wide; the start is in the
/// middle of the lower straight, at the origin along +x, beside a gate of orange cones.
inline DrivenCourse oval(int laps = 1, double spacing_m = 3.0) {
    constexpr double kHalfStraight_m = 10.0;
    constexpr double kRadius_m = 8.0;
    constexpr double kArc_m = std::numbers::pi * kRadius_m;
    DrivenCourse course;
    course.mission = laps == 1 ? Mission::autocross : Mission::trackdrive;
    course.lap_m = 4.0 * kHalfStraight_m + 2.0 * kArc_m;
    course.finish_m = laps * course.lap_m;
    course.pose = [lap_m = course.lap_m](double s_m) -> Pose {
        double s = std::fmod(s_m, lap_m);
        if (s < 0.0) s += lap_m;
        if (s <= kHalfStraight_m) return {{s, 0.0}, 0.0};
        s -= kHalfStraight_m;
        if (s <= kArc_m) {
            const double a = s / kRadius_m;
            return {{kHalfStraight_m + kRadius_m * std::sin(a), kRadius_m * (1.0 - std::cos(a))}, a};
        }
        s -= kArc_m;
        if (s <= 2.0 * kHalfStraight_m) return {{kHalfStraight_m - s, 2.0 * kRadius_m}, std::numbers::pi};
        s -= 2.0 * kHalfStraight_m;
        if (s <= kArc_m) {
            const double a = s / kRadius_m;
            return {{-kHalfStraight_m - kRadius_m * std::sin(a), kRadius_m * (1.0 + std::cos(a))},
                    std::numbers::pi + a};
        }
        return {{s - kArc_m - kHalfStraight_m, 0.0}, 2.0 * std::numbers::pi};
    };
    const auto gaps = static_cast<int>(std::round(course.lap_m / spacing_m));
    for (int i = 0; i < gaps; ++i) {
        const Pose at = course.pose(course.lap_m * i / gaps);
        const Point left(-std::sin(at.yaw_rad), std::cos(at.yaw_rad));
        for (const double side : {1.0, -1.0}) {
            const ConeColor color = i == 0       ? ConeColor::orange
                                    : side > 0.0 ? ConeColor::blue
                                                 : ConeColor::yellow;
            course.cones.push_back(
                {static_cast<ConeId>(course.cones.size()), at.position + side * 1.75 * left, color});
        }
    }
    return course;
}

/// A course from a gate of orange cones at the origin to another one 60 m on, behind a bend to the left;
/// cones stand up to `beyond_m` behind it.
inline DrivenCourse from_gate_to_gate(double beyond_m = 0.0) {
    constexpr double kStraight_m = 20.0;
    constexpr double kRadius_m = 15.0;
    DrivenCourse course;
    course.mission = Mission::autocross;
    course.finish_m = 60.0;
    course.pose = [](double s_m) -> Pose {
        if (s_m <= kStraight_m) return {{s_m, 0.0}, 0.0};
        const double a = std::min(1.0, (s_m - kStraight_m) / kRadius_m);
        const double rest_m = s_m - kStraight_m - a * kRadius_m;
        const Point bent(kStraight_m + kRadius_m * std::sin(a), kRadius_m * (1.0 - std::cos(a)));
        return {bent + rest_m * Point(std::cos(a), std::sin(a)), a};
    };
    for (double s_m = -8.0; s_m <= course.finish_m + beyond_m; s_m += 4.0) {
        const bool gate = s_m == 0.0 || s_m == course.finish_m;
        for (const double off_m : gate ? std::vector{-0.25, 0.25} : std::vector{0.0}) {
            const Pose at = course.pose(s_m + off_m);
            const Point left(-std::sin(at.yaw_rad), std::cos(at.yaw_rad));
            for (const double side : {1.0, -1.0}) {
                const ConeColor color = gate         ? ConeColor::orange
                                        : side > 0.0 ? ConeColor::blue
                                                     : ConeColor::yellow;
                course.cones.push_back(
                    {static_cast<ConeId>(course.cones.size()), at.position + side * 1.75 * left, color});
            }
        }
    }
    return course;
}

/// Acceleration or skidpad as a race drives it.
inline DrivenCourse mission_course(const experiments::RaceCourse& race) {
    DrivenCourse course;
    course.mission = race.mission;
    course.cones = race.cones;
    for (std::size_t i = 0; i < course.cones.size(); ++i) course.cones[i].id = static_cast<ConeId>(i);
    course.finish_m = *race.finish_m - race.start_m;
    course.pose = [line = race.line, step_m = race.step_m, start_m = race.start_m](double s_m) {
        const double place = std::clamp((start_m + s_m) / step_m, 0.0, static_cast<double>(line.size() - 1));
        const auto before = std::min(static_cast<std::size_t>(place), line.size() - 2);
        return between(line[before], line[before + 1], place - static_cast<double>(before));
    };
    return course;
}

inline DrivenCourse course_of(Mission mission) {
    if (mission == Mission::acceleration) return mission_course(experiments::acceleration_course());
    if (mission == Mission::skidpad) return mission_course(experiments::skidpad_course());
    return oval(mission == Mission::autocross ? 1 : 10);
}

/// Properties of a car's perception.
struct Sight {
    double range_m = 20.0;  ///< of the half disc ahead
    bool with_ids = true;
    bool with_color = false;
    double noise_m = 0.0;  ///< standard deviation of a seen position, along either axis
};

/// The frame of a car at `s_m`. `random` is used for noise only.
inline Frame frame_at(const DrivenCourse& course, double s_m, double time_s, const Sight& sight = {},
                      std::mt19937* random = nullptr) {
    Frame frame{time_s, course.pose(s_m), {}};
    for (const Cone& cone : course.cones) {
        if (frame.pose.ahead_m(cone.position) < 0.0) continue;
        if ((cone.position - frame.pose.position).norm() > sight.range_m) continue;
        frame.cones.push_back(cone);
        if (!sight.with_ids) frame.cones.back().id = kNoId;
        if (!sight.with_color) frame.cones.back().color = ConeColor::unknown;
        if (sight.noise_m > 0.0) {
            std::normal_distribution<double> noise(0.0, sight.noise_m);
            const double x_m = noise(*random);
            frame.cones.back().position += Point(x_m, noise(*random));
        }
    }
    return frame;
}

/// The largest distance of a lane from the middle of the course ahead of the car [m].
inline double farthest_from_middle_m(const DrivenCourse& course, double s_m, const DrivableLane& lane) {
    double farthest_m = 0.0;
    for (const DrivablePoint& point : lane.points) {
        double nearest_m = std::numeric_limits<double>::infinity();
        // The middle may cross itself: only the part that the lane can reach counts.
        for (double s = point.s_m - 4.0; s <= point.s_m + 4.0; s += 0.1) {
            nearest_m = std::min(nearest_m, (course.pose(s_m + s).position - point.position).norm());
        }
        farthest_m = std::max(farthest_m, nearest_m);
    }
    return farthest_m;
}

}  // namespace conelane::tests
