#pragma once

#include "conelane/drivable_lane.hpp"
#include "tests/support/testing.hpp"

#include <random>

namespace conelane::tests {

inline constexpr double kPi = std::numbers::pi;
inline constexpr ConeId kFirstRight = 1000;

/// A lane with its cones as a scene; the car stands at the origin and looks along +x.
struct Course {
    Lane lane;
    Scene scene;

    void add(const Point& position, bool on_left) {
        std::vector<ConeId>& ids = on_left ? lane.left : lane.right;
        const ConeId id = static_cast<ConeId>(ids.size()) + (on_left ? 0 : kFirstRight);
        ids.push_back(id);
        scene.cones.push_back({.id = id, .position = position});
    }
    [[nodiscard]] std::vector<Point> boundary(const std::vector<ConeId>& ids) const {
        return mapped(
            ids, [&](const ConeId id) { return std::ranges::find(scene.cones, id, &Cone::id)->position; });
    }
    [[nodiscard]] std::vector<Point> left() const { return boundary(lane.left); }
    [[nodiscard]] std::vector<Point> right() const { return boundary(lane.right); }
    [[nodiscard]] DrivableLane driven(const DrivableOptions& options = {}) const {
        return drivable(lane, scene, options);
    }
};

inline Course course_of(const std::vector<Point>& left, const std::vector<Point>& right,
                        bool closed = false) {
    Course course;
    for (const Point& point : left) course.add(point, true);
    for (const Point& point : right) course.add(point, false);
    course.lane.closed = closed;
    return course;
}

/// Cones along y = 1.75 on the left and y = -1.75 on the right.
inline Course straight(const std::vector<double>& left_x, const std::vector<double>& right_x) {
    Course course;
    for (const double x : left_x) course.add({x, 1.75}, true);
    for (const double x : right_x) course.add({x, -1.75}, false);
    return course;
}

inline std::vector<double> range(double from, double to, double step) {
    std::vector<double> values;
    for (int i = 0; from + step * i <= to + 1e-9; ++i) values.push_back(from + step * i);
    return values;
}

/// A circle of radius `radius_m` that starts at the origin along +x and turns left (`turn` 1) or right (-1),
/// with cones at most `spacing_m` apart.
inline Course circle(double radius_m, double turn, double spacing_m, double angle_rad, bool closed,
                     double half_width_m = 1.6) {
    Course course;
    course.lane.closed = closed;
    for (const bool on_left : {true, false}) {
        const double radius = radius_m + (on_left == (turn > 0.0) ? -half_width_m : half_width_m);
        const double gaps = std::ceil(angle_rad * radius / spacing_m);
        for (double i = 0; i < gaps + (closed ? 0.0 : 1.0); ++i) {
            const double angle = angle_rad * i / gaps;
            course.add({radius * std::sin(angle), turn * (radius_m - radius * std::cos(angle))}, on_left);
        }
    }
    return course;
}

/// Cones `half_width_m` beside a path of the given curvature, which starts at the origin along +x.
inline Course beside_path(const std::function<double(double)>& curvature_1pm, double length_m,
                          double spacing_m, double half_width_m = 1.75) {
    Course course;
    constexpr double kStep_m = 0.001;
    Point position(0.0, 0.0);
    double heading = 0.0;
    double next_m = 0.0;
    for (double s = 0.0; s < length_m + 0.5 * kStep_m; s += kStep_m) {
        const Point normal(-std::sin(heading), std::cos(heading));
        if (s >= next_m - 1e-9) {
            course.add(position + half_width_m * normal, true);
            course.add(position - half_width_m * normal, false);
            next_m += spacing_m;
        }
        heading += 0.5 * kStep_m * curvature_1pm(s + 0.25 * kStep_m);
        position += kStep_m * Point(std::cos(heading), std::sin(heading));
        heading += 0.5 * kStep_m * curvature_1pm(s + 0.75 * kStep_m);
    }
    return course;
}

/// A bend to the left, then one to the right, with cones off their places.
inline Course winding() {
    Course course = beside_path([](double s) { return 0.15 * std::sin(s / 5.0); }, 32.0, 3.0);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> shift(-0.15, 0.15);
    for (Cone& cone : course.scene.cones) cone.position += Point(shift(random), shift(random));
    return course;
}

}  // namespace conelane::tests
