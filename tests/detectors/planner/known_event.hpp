#pragma once

// The cones of acceleration and skidpad, placed by the numbers of the rules, independently of the planner's
// code.

#include "conelane/planner.hpp"

#include <random>

namespace conelane::known_event {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kCircle_m = kPi * 18.25;  ///< around the middle of a skidpad's lane

inline std::vector<Point> skidpad_cones() {
    std::vector<Point> cones;
    for (const double side : {-1.0, 1.0}) {
        const Point centre(0.0, side * 18.25 / 2.0);
        for (int i = 0; i < 16; ++i) {
            const double angle_rad = 2.0 * kPi * i / 16.0;
            const Point direction(std::cos(angle_rad), std::sin(angle_rad));
            cones.push_back(centre + 15.25 / 2.0 * direction);
            const Point outer = centre + 21.25 / 2.0 * direction;
            if (side * outer.y() > 1.6) cones.push_back(outer);
        }
        for (const double x_m : {-15.0, -11.25, 11.0, 16.0, 21.0}) cones.emplace_back(x_m, side * 1.5);
    }
    return cones;
}

/// `half_m`: half of the lane's width.
inline std::vector<Point> acceleration_cones(double half_m) {
    std::vector<Point> cones;
    for (const double side : {-1.0, 1.0}) {
        for (const double gate_m : {0.0, 75.0}) {
            for (const double off_m : {-0.3, 0.3}) cones.emplace_back(gate_m + off_m, side * half_m);
        }
        for (int i = 1; i < 15; ++i) cones.emplace_back(5.0 * i, side * half_m);
        for (int i = 16; i < 30; ++i) cones.emplace_back(5.0 * i, side * half_m);
    }
    return cones;
}

/// Placement of the course in a map: `course` is the pose of its origin and x axis.
inline Pose in_map(const Pose& course, const Pose& pose) {
    const double c = std::cos(course.yaw_rad);
    const double s = std::sin(course.yaw_rad);
    return {{course.position.x() + c * pose.position.x() - s * pose.position.y(),
             course.position.y() + s * pose.position.x() + c * pose.position.y()},
            std::remainder(course.yaw_rad + pose.yaw_rad, 2.0 * kPi)};
}

/// The middle of the lane at `s` after the line, by the rules: right twice, left twice, straight on.
inline Pose skidpad_route(double s_m) {
    if (s_m <= 0.0) return {{s_m, 0.0}, 0.0};
    if (s_m >= 4.0 * kCircle_m) return {{s_m - 4.0 * kCircle_m, 0.0}, 0.0};
    const double side = s_m < 2.0 * kCircle_m ? -1.0 : 1.0;
    const double angle_rad = 2.0 * kPi * s_m / kCircle_m;
    return {{9.125 * std::sin(angle_rad), side * (9.125 - 9.125 * std::cos(angle_rad))},
            std::remainder(side * angle_rad, 2.0 * kPi)};
}

/// What a car at `pose` (of the course) sees within 20 m ahead.
class Sight {
  public:
    Sight(std::vector<Point> cones, double noise_m, double miss_rate, unsigned seed)
        : cones_(std::move(cones)), noise_m_(noise_m), miss_rate_(miss_rate), random_(seed) {}

    Frame look(const Pose& pose, const Pose& course, double time_s) {
        Frame frame{time_s, in_map(course, pose), {}};
        for (const Point& cone : cones_) {
            if ((cone - pose.position).norm() > 20.0 || pose.ahead_m(cone) < 0.0) continue;
            if (std::uniform_real_distribution<double>()(random_) < miss_rate_) continue;
            const double x_m = noise_m_ * noise_(random_);
            const double y_m = noise_m_ * noise_(random_);
            frame.cones.push_back({kNoId, in_map(course, {cone + Point(x_m, y_m), 0.0}).position});
        }
        return frame;
    }
    /// Cones that belong to no course, evenly in a square around a place; `half_m` is half its side.
    static std::vector<Point> strewn(int count, const Point& about, double half_m, unsigned seed) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> any_m(-half_m, half_m);
        std::vector<Point> cones;
        for (int i = 0; i < count; ++i) {
            const double x_m = any_m(random);
            const double y_m = any_m(random);
            cones.push_back(about + Point(x_m, y_m));
        }
        return cones;
    }

  private:
    std::vector<Point> cones_;
    double noise_m_;
    std::normal_distribution<double> noise_;  // of standard deviation 1, since 0 is none
    double miss_rate_;
    std::mt19937 random_;
};

}  // namespace conelane::known_event
