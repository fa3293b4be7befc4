#include "experiments/race/course.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/tracks/centre_line.hpp"
#include "model/geometry.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace conelane::experiments {
namespace {

constexpr double kPi = std::numbers::pi;

void add_cone(RaceCourse& course, double x_m, double y_m, ConeColor color) {
    course.cones.push_back({static_cast<ConeId>(course.cones.size()), {x_m, y_m}, color});
}

/// Both sides of a lane along the x axis.
void add_pair(RaceCourse& course, double x_m, double half_width_m, ConeColor left, ConeColor right) {
    add_cone(course, x_m, half_width_m, left);
    add_cone(course, x_m, -half_width_m, right);
}

/// A line that is driven once, put together from straights and arcs.
class LineMaker {
  public:
    LineMaker(const Pose& start, double step_m) : pose_(start), step_m_(step_m) {}

    /// `curvature_1pm` is positive in a left bend.
    void go(double length_m, double curvature_1pm) {
        const Pose begin = pose_;
        const auto at = [&](double s_m) {
            Pose pose = begin;
            pose.yaw_rad += curvature_1pm * s_m;
            if (curvature_1pm == 0.0) {
                pose.position += s_m * begin.heading();
            } else {
                pose.position += Point(std::sin(pose.yaw_rad) - std::sin(begin.yaw_rad),
                                       std::cos(begin.yaw_rad) - std::cos(pose.yaw_rad)) /
                                 curvature_1pm;
            }
            return pose;
        };
        for (; next_m_ <= passed_m_ + length_m + 1e-9; next_m_ += step_m_) {
            poses_.push_back(at(next_m_ - passed_m_));
        }
        passed_m_ += length_m;
        pose_ = at(length_m);
    }
    [[nodiscard]] std::vector<Pose> take() { return std::move(poses_); }

  private:
    Pose pose_;
    double step_m_;
    double passed_m_ = 0.0;
    double next_m_ = 0.0;
    std::vector<Pose> poses_;
};

constexpr double kBehind_m = 20.0;  ///< of the start line: where the lines of missions begin

constexpr double kAccelerationHalfWidth_m = 1.9;
constexpr double kAcceleration_m = 75.0;
constexpr double kAccelerationRest_m = 100.0;

constexpr double kSkidpadRadius_m = 9.125;
constexpr double kSkidpadInner_m = 15.25 / 2.0;
constexpr double kSkidpadOuter_m = 21.25 / 2.0;
constexpr double kSkidpadHalfWidth_m = 1.5;
constexpr double kSkidpadRest_m = 25.0;

RaceCourse acceleration_shape() {
    RaceCourse course;
    course.name = "acceleration";
    course.mission = Mission::acceleration;
    LineMaker line({{-kBehind_m, 0.0}, 0.0}, course.step_m);
    line.go(kBehind_m + kAcceleration_m + kAccelerationRest_m + 10.0, 0.0);
    course.line = line.take();
    course.half_width_m = kAccelerationHalfWidth_m;
    course.start_m = kBehind_m - 2.0;
    course.finish_m = kBehind_m + kAcceleration_m;
    course.rest_m = kAccelerationRest_m;
    return course;
}

RaceCourse skidpad_shape() {
    RaceCourse course;
    course.name = "skidpad";
    course.mission = Mission::skidpad;
    const double two_rounds_m = 4.0 * kPi * kSkidpadRadius_m;
    LineMaker line({{-kBehind_m, 0.0}, 0.0}, course.step_m);
    line.go(kBehind_m, 0.0);
    line.go(two_rounds_m, -1.0 / kSkidpadRadius_m);
    line.go(two_rounds_m, 1.0 / kSkidpadRadius_m);
    line.go(kSkidpadRest_m + 10.0, 0.0);
    course.line = line.take();
    course.half_width_m = kSkidpadHalfWidth_m;
    course.start_m = kBehind_m - 16.0;
    course.finish_m = kBehind_m + 2.0 * two_rounds_m;
    course.rest_m = kSkidpadRest_m;
    course.phases = {"approach", "right 1", "right 2", "left 1", "left 2", "exit"};
    return course;
}

void measure(RaceCourse& course) {
    std::vector<Point> points;
    for (const Pose& pose : course.line) points.push_back(pose.position);
    course.length_m = polyline_length_m(points, course.closed);
}

}  // namespace

RaceCourse circuit(const Track& track) {
    if (!track.closed || !track.driven.empty()) {
        throw InvalidInput("tracks", "'" + track.name + "' is not a closed course with boundaries");
    }
    RaceCourse course;
    course.name = track.name;
    course.cones = track.cones;
    for (const std::size_t i : track.left) {
        if (course.cones[i].color != ConeColor::orange) course.cones[i].color = ConeColor::blue;
    }
    for (const std::size_t i : track.right) {
        if (course.cones[i].color != ConeColor::orange) course.cones[i].color = ConeColor::yellow;
    }
    course.closed = true;
    course.lane = boundaries(track);
    course.line = centre_line_poses(course.lane, course.step_m);
    course.rest_m = 30.0;
    measure(course);
    return course;
}

RaceCourse acceleration_course() {
    RaceCourse course = acceleration_shape();
    for (int i = 1; i < 15; ++i) {
        add_pair(course, 5.0 * i, kAccelerationHalfWidth_m, ConeColor::blue, ConeColor::yellow);
    }
    for (const double gate_m : {0.0, kAcceleration_m}) {
        for (const double offset_m : {-0.3, 0.3}) {
            add_pair(course, gate_m + offset_m, kAccelerationHalfWidth_m, ConeColor::orange,
                     ConeColor::orange);
        }
    }
    for (int i = 16; i <= 35; ++i) {
        add_pair(course, 5.0 * i, kAccelerationHalfWidth_m, ConeColor::orange, ConeColor::orange);
    }
    measure(course);
    return course;
}

RaceCourse skidpad_course() {
    RaceCourse course = skidpad_shape();
    constexpr int kConesPerCircle = 16;
    for (const double side : {-1.0, 1.0}) {
        const Point centre(0.0, side * kSkidpadRadius_m);
        for (int i = 0; i < kConesPerCircle; ++i) {
            const double angle_rad = 2.0 * kPi * i / kConesPerCircle;
            const Point direction(std::sin(angle_rad), -side * std::cos(angle_rad));
            const Point inner = centre + kSkidpadInner_m * direction;
            const Point outer = centre + kSkidpadOuter_m * direction;
            // Right of the car in the right circle are its inner cones, and they are yellow.
            add_cone(course, inner.x(), inner.y(), side < 0.0 ? ConeColor::yellow : ConeColor::blue);
            // Outer cones that would stand in the lane of entry, exit or the other circle are not set.
            if (std::abs(outer.y()) > kSkidpadHalfWidth_m + 0.1 && side * outer.y() > 0.0) {
                add_cone(course, outer.x(), outer.y(), side < 0.0 ? ConeColor::blue : ConeColor::yellow);
            }
        }
    }
    const double exit_m[] = {11.0, 16.0, 21.0, 25.0};
    const double entry_m[] = {-20.0, -15.0, -11.25};
    const double junction_m =
        std::sqrt(kSkidpadOuter_m * kSkidpadOuter_m - std::pow(kSkidpadRadius_m - kSkidpadHalfWidth_m, 2.0));
    for (const double x_m : {-junction_m, junction_m}) {
        add_pair(course, x_m, kSkidpadHalfWidth_m, ConeColor::yellow, ConeColor::blue);
    }
    for (const double x_m : entry_m) {
        add_pair(course, x_m, kSkidpadHalfWidth_m, ConeColor::orange, ConeColor::orange);
    }
    for (const double x_m : exit_m) {
        add_pair(course, x_m, kSkidpadHalfWidth_m, ConeColor::orange, ConeColor::orange);
    }
    for (const double x_m : {-1.3, 1.3}) add_pair(course, x_m, 2.0, ConeColor::orange, ConeColor::orange);
    add_cone(course, 25.0, 0.0, ConeColor::orange);
    measure(course);
    return course;
}

RaceCourse mission_course(Mission mission) {
    return mission == Mission::skidpad ? skidpad_course() : acceleration_course();
}

RaceCourse mission_course(Mission mission, const Track& track) {
    RaceCourse course = mission == Mission::skidpad ? skidpad_shape() : acceleration_shape();
    course.name = track.name;
    course.cones = track.cones;
    measure(course);
    return course;
}

}  // namespace conelane::experiments
