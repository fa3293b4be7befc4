#include "conelane/drivable_lane.hpp"

#include "conelane/invalid_input.hpp"
#include "experiments/scenes/scene_generation.hpp"
#include "experiments/tracks/generated_tracks.hpp"
#include "tests/boundary_checks.hpp"
#include "tests/recorded_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace conelane::experiments {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr ConeId kFirstRight = 1000;

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
        std::vector<Point> result;
        for (const ConeId id : ids) {
            result.push_back(std::ranges::find(scene.cones, id, &Cone::id)->position);
        }
        return result;
    }
    [[nodiscard]] std::vector<Point> left() const { return boundary(lane.left); }
    [[nodiscard]] std::vector<Point> right() const { return boundary(lane.right); }
    [[nodiscard]] DrivableLane driven(const DrivableOptions& options = {}) const {
        return drivable(lane, scene, options);
    }
};

Course course_of(const std::vector<Point>& left, const std::vector<Point>& right, bool closed = false) {
    Course course;
    for (const Point& point : left) course.add(point, true);
    for (const Point& point : right) course.add(point, false);
    course.lane.closed = closed;
    return course;
}

/// Cones along y = 1.75 on the left and y = -1.75 on the right.
Course straight(const std::vector<double>& left_x, const std::vector<double>& right_x) {
    Course course;
    for (const double x : left_x) course.add({x, 1.75}, true);
    for (const double x : right_x) course.add({x, -1.75}, false);
    return course;
}

std::vector<double> range(double from, double to, double step) {
    std::vector<double> values;
    for (int i = 0; from + step * i <= to + 1e-9; ++i) values.push_back(from + step * i);
    return values;
}

/// A circle of radius `radius_m` that starts at the origin along +x and turns left (`turn` 1) or right (-1),
/// with cones at most `spacing_m` apart.
Course circle(double radius_m, double turn, double spacing_m, double angle_rad, bool closed,
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
Course beside_path(const std::function<double(double)>& curvature_1pm, double length_m, double spacing_m,
                   double half_width_m = 1.75) {
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
Course winding() {
    Course course = beside_path([](double s) { return 0.15 * std::sin(s / 5.0); }, 32.0, 3.0);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> shift(-0.15, 0.15);
    for (Cone& cone : course.scene.cones) cone.position += Point(shift(random), shift(random));
    return course;
}

double sharpest(const DrivableLane& lane) {
    double most = 0.0;
    for (const DrivablePoint& point : lane.points) most = std::max(most, std::abs(point.curvature_1pm));
    return most;
}

bool all_finite(const DrivableLane& lane) {
    return std::isfinite(lane.length_m) && std::ranges::all_of(lane.points, [](const DrivablePoint& p) {
               return std::isfinite(p.s_m) && p.position.allFinite() && std::isfinite(p.heading_rad) &&
                      std::isfinite(p.curvature_1pm) && std::isfinite(p.width_left_m) &&
                      std::isfinite(p.width_right_m);
           });
}

/// Whether a point is inside of outlines, by the number of times that a ray from it meets them.
bool is_inside(const Point& point, const std::vector<Segment>& outlines) {
    bool inside = false;
    for (const Segment& side : outlines) {
        if ((side.from.y() > point.y()) == (side.to.y() > point.y())) continue;
        const double share = (point.y() - side.from.y()) / (side.to.y() - side.from.y());
        if (side.from.x() + share * (side.to.x() - side.from.x()) > point.x()) inside = !inside;
    }
    return inside;
}

/// What holds for every centre line: it goes on in equal steps along its heading, and neither its points nor
/// the lines between them touch a boundary or leave the lane.
void expect_drivable(const Course& course, const DrivableLane& lane, double step_m = 0.5) {
    ASSERT_GE(lane.points.size(), 2U);
    ASSERT_TRUE(all_finite(lane));
    const bool closed = course.lane.closed;
    const std::vector<Point> left = course.left();
    const std::vector<Point> right = course.right();
    std::vector<Segment> boundaries = segments(left, closed);
    std::ranges::copy(segments(right, closed), std::back_inserter(boundaries));
    // What of a boundary goes on round a bend after the other one has ended bounds no lane.
    std::vector<Point> left_beside = left;
    std::vector<Point> right_beside = right;
    const auto drop_far = [&](std::vector<Point>& boundary, const Point& end) {
        Point far = boundary.back();
        while (!closed && boundary.size() > 1 && (boundary.back() - end).norm() > kWidestLane_m) {
            far = boundary.back();
            boundary.pop_back();
        }
        Point near = boundary.back();
        for (int i = 0; i < 40; ++i) {  // to where it is kWidestLane_m away
            const Point middle = 0.5 * (near + far);
            ((middle - end).norm() > kWidestLane_m ? far : near) = middle;
        }
        boundary.push_back(near);
    };
    if (polyline_length_m(left) > polyline_length_m(right)) {
        drop_far(left_beside, right.back());
    } else {
        drop_far(right_beside, left.back());
    }
    std::vector<Segment> outlines = segments(left_beside, closed);
    std::ranges::copy(segments(right_beside, closed), std::back_inserter(outlines));
    const std::vector<Segment> ends{{left_beside.front(), right_beside.front()},
                                    {left_beside.back(), right_beside.back()}};
    if (!closed) std::ranges::copy(ends, std::back_inserter(outlines));
    const double spacing_m = lane.closed ? lane.length_m / static_cast<double>(lane.points.size()) : step_m;
    EXPECT_NEAR(spacing_m, step_m, step_m * step_m / lane.length_m);
    if (!lane.closed) {
        EXPECT_GE(lane.length_m, lane.points.back().s_m);
        EXPECT_LT(lane.length_m, lane.points.back().s_m + step_m);
    }
    std::vector<Point> line;
    for (const DrivablePoint& point : lane.points) line.push_back(point.position);
    for (std::size_t i = 0; i < line.size(); ++i) {
        const DrivablePoint& point = lane.points[i];
        EXPECT_NEAR(point.s_m, static_cast<double>(i) * spacing_m, 1e-9 * (1.0 + point.s_m));
        EXPECT_GT(point.width_left_m, 0.2) << i;
        EXPECT_GT(point.width_right_m, 0.2) << i;
        const bool at_end = !closed && std::ranges::any_of(ends, [&](const Segment& end) {
            return foot_point(point.position, end).distance_m < 0.3;
        });
        EXPECT_TRUE(at_end || is_inside(point.position, outlines)) << i;
    }
    for (std::size_t i = 0; i + (lane.closed ? 0 : 1) < line.size(); ++i) {
        const DrivablePoint& here = lane.points[i];
        const DrivablePoint& next = lane.points[(i + 1) % line.size()];
        const Segment step{here.position, next.position};
        EXPECT_NEAR((step.to - step.from).norm(), spacing_m, 0.02 * spacing_m) << i;
        const double turn = std::remainder(next.heading_rad - here.heading_rad, 2.0 * kPi);
        const double mean_1pm = 0.5 * (here.curvature_1pm + next.curvature_1pm);
        EXPECT_NEAR(turn, mean_1pm * spacing_m, 0.03) << i;
        const double way = std::atan2(step.to.y() - step.from.y(), step.to.x() - step.from.x());
        EXPECT_NEAR(std::remainder(way - here.heading_rad - 0.5 * turn, 2.0 * kPi), 0.0, 0.02) << i;
        for (const Segment& side : boundaries) EXPECT_FALSE(segments_intersect(step, side)) << i;
    }
}

TEST(DrivableLane, IsTheMiddleOfAStraightLane) {
    Course course = straight(range(-10.0, 30.0, 4.0), range(-9.0, 31.0, 5.0));
    course.scene.pose = {{5.3, 0.6}, 0.1};
    const DrivableLane lane = course.driven();
    expect_drivable(course, lane);
    EXPECT_FALSE(lane.closed);
    EXPECT_NEAR(lane.length_m, 30.0 - 5.3, 0.6);  // to half-way between x = 30 and x = 31
    for (const DrivablePoint& point : lane.points) {
        EXPECT_NEAR(point.position.x(), 5.3 + point.s_m, 1e-6);
        EXPECT_NEAR(point.position.y(), 0.0, 1e-9);
        EXPECT_NEAR(point.heading_rad, 0.0, 1e-9);
        EXPECT_NEAR(point.curvature_1pm, 0.0, 1e-9);
        EXPECT_NEAR(point.width_left_m, 1.75, 1e-9);
        EXPECT_NEAR(point.width_right_m, 1.75, 1e-9);
    }
}

TEST(DrivableLane, KnowsTheCurvatureOfCircles) {
    for (const double turn : {1.0, -1.0}) {
        for (const double radius_m : {6.0, 10.0, 25.0}) {
            for (const double spacing_m : {1.0, 2.0, 3.0}) {
                for (const bool closed : {false, true}) {
                    SCOPED_TRACE(testing::Message() << "radius " << radius_m << " turn " << turn
                                                    << " spacing " << spacing_m << " closed " << closed);
                    const double angle = closed ? 2.0 * kPi : std::min(4.0, 35.0 / radius_m);
                    const Course course = circle(radius_m, turn, spacing_m, angle, closed);
                    const DrivableLane lane = course.driven();
                    expect_drivable(course, lane);
                    EXPECT_EQ(lane.closed, closed);
                    // A boundary of straight pieces runs inside its circle by their sagitta.
                    const double sagitta_m = spacing_m * spacing_m / 8.0 / (radius_m - 1.6);
                    for (const DrivablePoint& point : lane.points) {
                        // The last piece of either boundary shows no bend.
                        const bool at_end = !closed && (point.s_m < 4.0 || point.s_m > lane.length_m - 4.0);
                        EXPECT_NEAR(point.curvature_1pm * radius_m, turn,
                                    (at_end ? 0.04 : 0.01) + 1.2 * sagitta_m / radius_m)
                            << point.s_m;
                        const double off_m = (point.position - Point(0.0, turn * radius_m)).norm() - radius_m;
                        EXPECT_LT(off_m, 0.01);
                        EXPECT_GT(off_m, -0.02 - sagitta_m);
                    }
                }
            }
        }
    }
}

TEST(DrivableLane, KnowsTheCurvatureOfClothoids) {
    for (const double turn : {1.0, -1.0}) {
        for (const double spacing_m : {1.0, 2.0, 3.0}) {
            SCOPED_TRACE(testing::Message() << "turn " << turn << " spacing " << spacing_m);
            const auto curvature = [&](double s) { return turn * (-0.08 + 0.007 * s); };
            const Course course = beside_path(curvature, 30.0, spacing_m);
            const DrivableLane lane = course.driven();
            expect_drivable(course, lane);
            EXPECT_NEAR(lane.length_m, 30.0, 0.8);
            for (const DrivablePoint& point : lane.points) {
                // The ends of an open line go on as a circle over some metres.
                const bool at_end = point.s_m < 3.5 || point.s_m > lane.length_m - 3.5;
                EXPECT_NEAR(point.curvature_1pm, curvature(point.s_m), at_end ? 0.03 : 0.008) << point.s_m;
            }
        }
    }
}

TEST(DrivableLane, ClosesAClosedLane) {
    Course course = circle(12.0, 1.0, 2.5, 2.0 * kPi, true);
    course.scene.pose = {{12.5, 12.0}, kPi / 2.0};
    const DrivableLane lane = course.driven({.step_m = 0.7});
    expect_drivable(course, lane, 0.7);
    EXPECT_TRUE(lane.closed);
    EXPECT_NEAR(lane.length_m, 2.0 * kPi * 12.0, 1.0);
    // From the foot point on.
    EXPECT_NEAR(lane.points.front().position.y(), 12.0, 0.02);
    EXPECT_NEAR(lane.points.front().position.x(), 12.0, 0.2);
    EXPECT_NEAR(lane.points.front().heading_rad, kPi / 2.0, 0.02);
    EXPECT_NEAR((lane.points.back().position - lane.points.front().position).norm(),
                lane.length_m / static_cast<double>(lane.points.size()), 0.01);
}

TEST(DrivableLane, MirroredLanesHaveMirroredCentreLines) {
    const Course course = winding();
    Course mirrored = course;
    for (Cone& cone : mirrored.scene.cones) cone.position.y() = -cone.position.y();
    std::swap(mirrored.lane.left, mirrored.lane.right);
    const DrivableLane lane = course.driven();
    const DrivableLane other = mirrored.driven();
    expect_drivable(course, lane);
    ASSERT_EQ(other.points.size(), lane.points.size());
    for (std::size_t i = 0; i < lane.points.size(); ++i) {
        const DrivablePoint& a = lane.points[i];
        const DrivablePoint& b = other.points[i];
        EXPECT_NEAR(a.position.x(), b.position.x(), 1e-9);
        EXPECT_NEAR(a.position.y(), -b.position.y(), 1e-9);
        EXPECT_NEAR(a.heading_rad, -b.heading_rad, 1e-9);
        EXPECT_NEAR(a.curvature_1pm, -b.curvature_1pm, 1e-9);
        EXPECT_NEAR(a.width_left_m, b.width_right_m, 1e-9);
        EXPECT_NEAR(a.width_right_m, b.width_left_m, 1e-9);
    }
}

TEST(DrivableLane, MovesWithItsConesAndTheCar) {
    const Course course = winding();
    const DrivableLane lane = course.driven();
    for (const double angle : {0.4, 2.0, -3.0}) {
        const Point shift(8e5, -7e5);
        const Eigen::Rotation2Dd rotation(angle);
        Course moved = course;
        for (Cone& cone : moved.scene.cones) cone.position = rotation * cone.position + shift;
        moved.scene.pose = {shift, angle};
        const DrivableLane other = moved.driven();
        ASSERT_EQ(other.points.size(), lane.points.size());
        for (std::size_t i = 0; i < lane.points.size(); ++i) {
            const DrivablePoint& a = lane.points[i];
            const DrivablePoint& b = other.points[i];
            EXPECT_LT((rotation * a.position + shift - b.position).norm(), 1e-6);
            EXPECT_NEAR(std::remainder(a.heading_rad + angle - b.heading_rad, 2.0 * kPi), 0.0, 1e-6);
            EXPECT_NEAR(a.curvature_1pm, b.curvature_1pm, 1e-6);
            EXPECT_NEAR(a.width_left_m, b.width_left_m, 1e-6);
        }
    }
}

TEST(DrivableLane, StartsOnTheLegOfAHairpinThatRunsTheCarsWay) {
    // Out along y = 0, back along y = 4.4: the car is nearer to the way back, but heads out.
    const Course leg =
        beside_path([](double s) { return s > 20.0 && s < 20.0 + 2.2 * kPi ? 1.0 / 2.2 : 0.0; },
                    40.0 + 2.2 * kPi, 1.0, 1.5);
    Course course = leg;
    course.scene.pose = {{6.0, 2.4}, 0.0};
    EXPECT_NEAR(course.driven().points.front().position.y(), 0.0, 0.05);
    EXPECT_NEAR(course.driven().points.front().position.x(), 6.0, 0.05);
    course.scene.pose.yaw_rad = kPi;
    EXPECT_NEAR(course.driven().points.front().position.y(), 4.4, 0.15);
    course.scene.pose = {{-30.0, 0.3}, 0.0};
    EXPECT_NEAR(course.driven().points.front().position.x(), 0.0, 0.01);  // the lane begins ahead of the car
}

TEST(DrivableLane, TakesAnyStep) {
    const Course course = winding();
    const double length_m = course.driven().length_m;
    for (const double step_m : {0.01, 0.3, 1.0, 7.0, 100.0}) {
        const DrivableLane lane = course.driven({.step_m = step_m});
        EXPECT_NEAR(lane.length_m, length_m, 1e-9);
        EXPECT_EQ(lane.points.size(), static_cast<std::size_t>(length_m / step_m) + 1);
        EXPECT_NEAR(lane.points.back().s_m, step_m * static_cast<double>(lane.points.size() - 1), 1e-9);
    }
    const Course closed = circle(10.0, -1.0, 2.0, 2.0 * kPi, true);
    EXPECT_EQ(closed.driven({.step_m = 100.0}).points.size(), 3U);
}

TEST(DrivableLane, WidthsEndAtTheBoundaries) {
    Course course = circle(9.0, -1.0, 3.5, 2.0 * kPi, true);
    for (std::size_t i = 0; i < course.scene.cones.size(); i += 3) {  // wider here and there
        course.scene.cones[i].position += 0.04 * (course.scene.cones[i].position - Point(0.0, -9.0));
    }
    const DrivableLane lane = course.driven();
    expect_drivable(course, lane);
    for (const DrivablePoint& point : lane.points) {
        const Point normal(-std::sin(point.heading_rad), std::cos(point.heading_rad));
        const auto off_m = [&](const Point& end, const std::vector<Point>& boundary) {
            return foot_on_polyline(end, boundary, true).distance_m;
        };
        EXPECT_LT(off_m(point.position + point.width_left_m * normal, course.left()), 1e-9);
        EXPECT_LT(off_m(point.position - point.width_right_m * normal, course.right()), 1e-9);
        EXPECT_NEAR(point.width_left_m, point.width_right_m, 0.7);
    }
}

TEST(DrivableLane, KeepsItsWidthWhereOneBoundaryEndsFirst) {
    // The longer boundary counts within 6.5 m of the other one's end, half of it for the middle.
    const Course longer_right = straight({0.0, 4.0}, range(0.0, 28.0, 4.0));
    const double beyond_m = std::sqrt(6.5 * 6.5 - 3.5 * 3.5);
    for (Course course : {longer_right, straight(range(0.0, 28.0, 4.0), {0.0, 4.0})}) {
        const DrivableLane lane = course.driven();
        expect_drivable(course, lane);
        EXPECT_NEAR(lane.length_m, 4.0 + beyond_m / 2.0, 0.5);
        for (const DrivablePoint& point : lane.points) {
            EXPECT_NEAR(point.position.y(), 0.0, 1e-6);
            EXPECT_NEAR(point.width_left_m, 1.75, 1e-6);
            EXPECT_NEAR(point.width_right_m, 1.75, 1e-6);
        }
    }
    Course single = straight({10.0}, range(0.0, 20.0, 4.0));
    const DrivableLane lane = single.driven();
    EXPECT_NEAR(lane.length_m, beyond_m, 1.0);
    for (const DrivablePoint& point : lane.points) EXPECT_NEAR(point.position.y(), 0.0, 0.02);
    EXPECT_NEAR(lane.points.front().position.x(), 10.0 - beyond_m / 2.0, 0.5);
}

TEST(DrivableLane, DoesNotFollowABoundaryRoundABendThatTheOtherDoesNotShow) {
    // The outer boundary ends in the hairpin, the inner one comes back: seen from its end, the way back is
    // outside of the lane.
    Course course;
    const double inner_m = 1.5;
    for (double x = 0.0; x < 20.0; x += 2.0) {
        course.add({x, inner_m}, true);
        course.add({x, -inner_m}, false);
    }
    for (double angle = 0.0; angle < 3.2; angle += 0.5) {
        const Point out(std::sin(angle), -std::cos(angle));
        course.add(Point(20.0, 3.0) + 1.5 * out, true);
        if (angle < 1.3) course.add(Point(20.0, 3.0) + 4.5 * out, false);
    }
    for (double x = 18.0; x > 0.0; x -= 2.0) course.add({x, 4.5}, true);
    const DrivableLane lane = course.driven();
    expect_drivable(course, lane);
    EXPECT_LT(lane.length_m, 27.0);
    EXPECT_GT(lane.length_m, 20.0);
}

TEST(DrivableLane, DrivesHairpinsWithFewInnerCones) {
    for (const double turn : {1.0, -1.0}) {
        for (const double inner_radius_m : {3.0, 3.7, 4.5}) {
            for (const double spacing_m : {1.5, 3.0, 4.5}) {
                SCOPED_TRACE(testing::Message() << inner_radius_m << " " << spacing_m);
                const double radius_m = inner_radius_m + 1.75;
                Course course = beside_path(
                    [&](double s) { return s > 10.0 && s < 10.0 + kPi * radius_m ? turn / radius_m : 0.0; },
                    20.0 + kPi * radius_m, spacing_m);
                const DrivableLane lane = course.driven();
                expect_drivable(course, lane);
                EXPECT_GT(lane.length_m, 17.0 + kPi * radius_m - spacing_m);
                EXPECT_LT(sharpest(lane), 1.6 / radius_m);
            }
        }
    }
}

TEST(DrivableLane, SharpCornersAreRoundedWithinTheLane) {
    const Course course =
        course_of({{0, 2}, {4, 2}, {8, 2}, {8, 6}, {8, 10}, {8, 14}},
                  {{0, -2}, {4, -2}, {8, -2}, {12, -2}, {12, 2}, {12, 6}, {12, 10}, {12, 14}});
    const DrivableLane lane = course.driven();
    expect_drivable(course, lane);
    EXPECT_LT(sharpest(lane), 0.45);
    EXPECT_NEAR(lane.points.back().heading_rad, kPi / 2.0, 0.15);
}

TEST(DrivableLane, DoubledAndCoincidentConesChangeLittle) {
    const Course course = winding();
    Course doubled = course;
    const auto add_beside = [&](const Point& shift) {
        Cone cone = doubled.scene.cones[10];  // the sixth on the left
        cone.id = 77;
        cone.position += shift;
        doubled.scene.cones.push_back(cone);
        doubled.lane.left.insert(doubled.lane.left.begin() + 6, cone.id);
    };
    const DrivableLane lane = course.driven();
    for (const Point& shift : {Point(0.0, 0.0), Point(0.2, 0.05), Point(-0.1, -0.1)}) {
        doubled = course;
        add_beside(shift);
        const DrivableLane other = doubled.driven();
        expect_drivable(doubled, other);
        ASSERT_EQ(other.points.size(), lane.points.size());
        for (std::size_t i = 0; i < lane.points.size(); ++i) {
            EXPECT_LT((other.points[i].position - lane.points[i].position).norm(), 0.15);
        }
    }
}

TEST(DrivableLane, InfersABoundaryOfWhichNoConeIsKnown) {
    for (const bool on_left : {true, false}) {
        SCOPED_TRACE(on_left);
        const double side = on_left ? 1.0 : -1.0;
        Course course = straight(range(1.0, 25.0, 4.0), range(1.0, 25.0, 4.0));
        (on_left ? course.lane.right : course.lane.left).clear();
        for (const double width_m : {3.0, 3.5, 4.5}) {
            const DrivableLane lane = course.driven({.usual_width_m = width_m});
            EXPECT_EQ(lane.left_inferred, !on_left);
            EXPECT_EQ(lane.right_inferred, on_left);
            EXPECT_NEAR(lane.length_m, 24.0, 0.6);
            for (const DrivablePoint& point : lane.points) {
                EXPECT_NEAR(point.position.y(), side * (1.75 - 0.5 * width_m), 1e-6);
                EXPECT_NEAR(point.width_left_m, 0.5 * width_m, 1e-6);
                EXPECT_NEAR(point.width_right_m, 0.5 * width_m, 1e-6);
            }
        }
    }
    const DrivableLane both = straight(range(1.0, 25.0, 4.0), range(1.0, 25.0, 4.0)).driven();
    EXPECT_FALSE(both.left_inferred || both.right_inferred);
}

TEST(DrivableLane, AnInferredBoundaryFollowsBends) {
    for (const double turn : {1.0, -1.0}) {
        for (const double radius_m : {6.0, 10.0, 25.0}) {
            for (const bool on_left : {true, false}) {
                SCOPED_TRACE(testing::Message()
                             << "radius " << radius_m << " turn " << turn << " left " << on_left);
                const double angle = std::min(3.0, 30.0 / radius_m);
                Course course = circle(radius_m, turn, 2.5, angle, false, 1.75);
                (on_left ? course.lane.right : course.lane.left).clear();
                const DrivableLane lane = course.driven();
                EXPECT_EQ(lane.right_inferred, on_left);
                EXPECT_GT(lane.length_m, 0.8 * angle * radius_m);
                for (const DrivablePoint& point : lane.points) {
                    const double off_m = (point.position - Point(0.0, turn * radius_m)).norm() - radius_m;
                    EXPECT_NEAR(off_m, 0.0, 0.4) << point.s_m;
                    EXPECT_GT(std::min(point.width_left_m, point.width_right_m), 1.2) << point.s_m;
                }
            }
        }
    }
}

TEST(DrivableLane, AnyBoundaryAloneGivesALineBesideIt) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> turn(-1.3, 1.3);
    std::uniform_real_distribution<double> step_m(0.2, 7.0);
    std::size_t lanes = 0;
    for (int i = 0; i < 300; ++i) {
        SCOPED_TRACE(i);
        Course course;
        Point at(1.0, i % 2 == 0 ? 1.75 : -1.75);
        double heading = 0.0;
        for (int cone = 0; cone < 2 + i % 9; ++cone) {
            course.add(at, i % 2 == 0);
            heading += turn(random);
            at += step_m(random) * Point(std::cos(heading), std::sin(heading));
        }
        const DrivableLane lane = course.driven();
        ASSERT_TRUE(all_finite(lane));
        EXPECT_FALSE(lane.closed);
        if (lane.points.empty()) continue;
        ++lanes;
        EXPECT_NE(lane.left_inferred, lane.right_inferred);
        for (std::size_t k = 1; k < lane.points.size(); ++k) {
            const Segment step{lane.points[k - 1].position, lane.points[k].position};
            for (const Segment& known : segments(i % 2 == 0 ? course.left() : course.right(), false))
                EXPECT_FALSE(segments_intersect(step, known)) << k;
        }
    }
    EXPECT_GT(lanes, 200U);
}

TEST(DrivableLane, ALaneWithoutExtentHasNoPoints) {
    const auto expect_none = [](const Course& course) {
        const DrivableLane lane = course.driven();
        EXPECT_TRUE(lane.points.empty());
        EXPECT_EQ(lane.length_m, 0.0);
        EXPECT_FALSE(lane.closed);
    };
    expect_none({});
    expect_none(straight({}, {4.0}));
    expect_none(straight({4.0, 4.0}, {}));
    expect_none(straight({4.0}, {4.0}));
    expect_none(straight({4.0, 4.0, 4.0}, {4.0, 4.0}));
    expect_none(straight({4.0, 4.1}, {4.0, 4.2}));
    expect_none(course_of({{4, 0}, {4, 0}}, {{4, 0}, {4, 0}}));
    expect_none(course_of({{0, 0}, {4, 0}, {8, 0}}, {{0, 0}, {4, 0}, {8, 0}}));     // no width
    expect_none(course_of({{0, -2}, {4, -2}, {8, -2}}, {{0, 2}, {4, 2}, {8, 2}}));  // swapped sides
    expect_none(course_of({{0, 0}, {4, 0}, {8, 0}}, {{0, 0.6}, {4, 0.6}, {8, 0.6}}));
}

TEST(DrivableLane, EndsWhereItsBoundariesMeet) {
    const Course crossing =
        course_of({{0, 2}, {10, 2}, {20, -2}, {30, -2}}, {{0, -2}, {10, -2}, {20, 2}, {30, 2}});
    const DrivableLane lane = crossing.driven();
    EXPECT_GT(lane.length_m, 10.0);
    EXPECT_LT(lane.length_m, 15.0);
    for (const DrivablePoint& point : lane.points) {
        EXPECT_GT(point.width_left_m, 0.2);
        EXPECT_GT(point.width_right_m, 0.2);
        EXPECT_LT(point.position.x(), 15.0);
    }
    // A closed lane with a narrow place is open, from the car to there.
    Course closed = circle(12.0, 1.0, 2.0, 2.0 * kPi, true);
    Cone& inner = closed.scene.cones[closed.lane.left.size() / 2];
    inner.position = Point(0.0, 12.0) + (inner.position - Point(0.0, 12.0)) * 13.4 / 10.4;
    const DrivableLane open = closed.driven();
    EXPECT_FALSE(open.closed);
    EXPECT_GT(open.length_m, 30.0);
    EXPECT_LT(open.length_m, 38.0);
}

void expect_refused(const Course& course, const std::string& key, const DrivableOptions& options = {}) {
    try {
        static_cast<void>(course.driven(options));
        ADD_FAILURE() << "not refused: " << key;
    } catch (const InvalidInput& error) {
        EXPECT_EQ(error.key(), key) << error.what();
    }
}

TEST(DrivableLane, RefusesWhatIsNoLaneOfTheScene) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinity = std::numeric_limits<double>::infinity();
    const Course good = straight(range(0.0, 20.0, 4.0), range(0.0, 20.0, 4.0));
    const auto with = [&](const std::function<void(Course&)>& change) {
        Course course = good;
        change(course);
        return course;
    };
    expect_refused(with([](Course& c) { c.lane.left[2] = 555; }), "left[2]");
    expect_refused(with([](Course& c) { c.lane.right[1] = c.lane.left[0]; }), "right[1]");
    expect_refused(with([](Course& c) { c.lane.right.push_back(c.lane.right[0]); }), "right[6]");
    expect_refused(with([](Course& c) { c.scene.cones.push_back(c.scene.cones[3]); }), "left[3]");
    expect_refused(with([&](Course& c) { c.scene.cones[1].position.x() = nan; }), "left[1]");
    expect_refused(with([&](Course& c) { c.scene.cones[1].position.y() = -infinity; }), "left[1]");
    expect_refused(with([](Course& c) { c.scene.cones[1].position.y() = 2e6; }), "left[1]");
    expect_refused(with([](Course& c) { c.scene.cones[1].position.x() = 1e5; }), "left");
    expect_refused(with([&](Course& c) { c.scene.pose.position.x() = nan; }), "pose");
    expect_refused(with([&](Course& c) { c.scene.pose.yaw_rad = infinity; }), "pose.yaw");
    expect_refused(with([](Course& c) {
                       c.lane.closed = true;
                       c.lane.right.resize(2);
                   }),
                   "right");
    for (const double step : {0.0, -1.0, 0.009, 100.1, nan, infinity}) {
        expect_refused(good, "step_m", {.step_m = step});
    }
    for (const double smoothing : {0.2, 5.1, nan})
        expect_refused(good, "smoothing_m", {.smoothing_m = smoothing});
    for (const double gap : {0.0, nan}) expect_refused(good, "longest_gap_m", {.longest_gap_m = gap});
}

TEST(DrivableLane, ConesOfNoLaneDoNotMatter) {
    Course course = winding();
    const DrivableLane lane = course.driven();
    course.scene.cones.push_back({.id = 99, .position = {3.0, std::numeric_limits<double>::quiet_NaN()}});
    std::ranges::reverse(course.scene.cones);
    const DrivableLane other = course.driven();
    ASSERT_EQ(other.points.size(), lane.points.size());
    for (std::size_t i = 0; i < lane.points.size(); ++i) {
        EXPECT_EQ(other.points[i].position, lane.points[i].position);
    }
}

TEST(DrivableLane, MarksGapsThatAConeIsMissingIn) {
    Course course = straight({0.0, 4.0, 12.0, 16.0, 20.0}, range(0.0, 20.0, 4.0));
    course.scene.pose.position = {2.0, 0.0};
    DrivableLane lane = course.driven();
    ASSERT_EQ(lane.bridged.size(), 1U);
    EXPECT_TRUE(lane.bridged[0].on_left);
    EXPECT_NEAR(lane.bridged[0].from_s_m, 2.0, 0.6);
    EXPECT_NEAR(lane.bridged[0].to_s_m, 10.0, 0.6);
    EXPECT_TRUE(course.driven({.longest_gap_m = 8.5}).bridged.empty());
    EXPECT_EQ(course.driven({.longest_gap_m = 3.9}).bridged.size(), 9U);
    course.scene.pose.position = {9.0, 0.0};
    lane = course.driven();
    ASSERT_EQ(lane.bridged.size(), 1U);
    EXPECT_EQ(lane.bridged[0].from_s_m, 0.0);
    EXPECT_NEAR(lane.bridged[0].to_s_m, 3.0, 0.6);
    course.scene.pose.position = {13.0, 0.0};
    EXPECT_TRUE(course.driven().bridged.empty());
}

TEST(DrivableLane, MarksGapsOfAClosedLaneRoundItsStart) {
    const Course round = circle(12.0, 1.0, 3.0, 2.0 * kPi, true);
    for (const bool on_left : {true, false}) {
        for (std::size_t missing = 0; missing < 10; ++missing) {
            Course course = round;
            std::vector<ConeId>& ids = on_left ? course.lane.left : course.lane.right;
            const std::size_t cones = ids.size();
            ids.erase(ids.begin() + static_cast<std::ptrdiff_t>(missing));
            for (const double start : {0.0, 0.7, 3.0}) {
                course.scene.pose = {{12.0 * std::sin(start), 12.0 - 12.0 * std::cos(start)}, start};
                const DrivableLane lane = course.driven();
                ASSERT_EQ(lane.bridged.size(), 1U);
                const BridgedGap& gap = lane.bridged[0];
                EXPECT_EQ(gap.on_left, on_left);
                EXPECT_GE(gap.from_s_m, 0.0);
                EXPECT_LT(gap.from_s_m, lane.length_m);
                const double share = 1.0 / static_cast<double>(cones);
                EXPECT_NEAR(gap.to_s_m - gap.from_s_m, 2.0 * share * lane.length_m, 0.5);
                const double middle = share * static_cast<double>(missing) - start / (2.0 * kPi);
                EXPECT_NEAR(std::remainder(0.5 * (gap.from_s_m + gap.to_s_m) / lane.length_m - middle, 1.0),
                            0.0, 0.01);
            }
        }
    }
}

TEST(DrivableLane, PassesOnHowFarTheDetectorTrustsALane) {
    const Course course = straight(range(0.0, 20.0, 4.0), range(0.0, 20.0, 4.0));
    LaneAnswer answer;
    answer.status = LaneStatus::found;
    answer.lane = course.lane;
    EXPECT_EQ(drivable(answer, course.scene).trusted_m, std::nullopt);
    answer.trusted_m = 12.5;
    EXPECT_EQ(drivable(answer, course.scene).trusted_m, 12.5);
    EXPECT_EQ(drivable(answer, course.scene).points.size(), 41U);
    answer.trusted_m = 50.0;
    EXPECT_NEAR(drivable(answer, course.scene).trusted_m.value(), 20.0, 0.1);
    answer.status = LaneStatus::stopped;
    EXPECT_TRUE(drivable(answer, course.scene).points.empty());
}

TEST(DrivableLane, AnyLaneGivesFiniteNumbers) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> anywhere(-15.0, 15.0);
    std::uniform_int_distribution<int> count(1, 9);
    std::size_t with_points = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        SCOPED_TRACE(trial);
        Course course;
        for (const bool on_left : {true, false}) {
            for (int i = count(random); i > 0; --i) {
                const bool on_grid = trial % 3 == 0;  // collinear and coincident cones
                const Point place(anywhere(random), anywhere(random));
                course.add(on_grid ? Point((place / 5.0).array().round() * 5.0) : place, on_left);
            }
        }
        course.lane.closed = trial % 2 == 0 && course.lane.left.size() > 4 && course.lane.right.size() > 4;
        course.scene.pose = {{anywhere(random), anywhere(random)}, anywhere(random)};
        DrivableLane lane;
        try {
            lane = course.driven();
        } catch (const InvalidInput&) {  // closed, and too few cones at different places
            EXPECT_TRUE(course.lane.closed);
            continue;
        }
        EXPECT_TRUE(all_finite(lane));
        EXPECT_EQ(lane.points.empty(), lane.length_m == 0.0);
        with_points += lane.points.empty() ? 0 : 1;
        for (const DrivablePoint& point : lane.points) {
            EXPECT_GT(std::min(point.width_left_m, point.width_right_m), 0.0);
        }
    }
    EXPECT_GT(with_points, 300U);
}

Course whole(const Track& track) {
    Course course;
    course.scene.cones = track.cones;
    for (const std::size_t i : track.left) course.lane.left.push_back(track.cones[i].id);
    for (const std::size_t i : track.right) course.lane.right.push_back(track.cones[i].id);
    course.lane.closed = track.closed;
    const std::vector<Point> left = course.left();
    const std::vector<Point> right = course.right();
    course.scene.pose.position = 0.5 * (left[0] + foot_on_polyline(left[0], right, track.closed).point);
    const Point ahead = left[1] - left[0];
    course.scene.pose.yaw_rad = std::atan2(ahead.y(), ahead.x());
    return course;
}

/// What holds for the scenes of a course.
struct DrivableBounds {
    double sharpest_1pm = 0.5;
    std::size_t short_lanes = 0;  ///< that end long before the scene's boundaries do
    std::size_t one_sided = 0;    ///< scenes left out, whose runs end far from each other
};

/// The whole course and the ground truth of scenes along it.
void expect_drivable_track(const Track& track, const DrivableBounds& bounds = {}) {
    SCOPED_TRACE(track.name);
    const Course course = whole(track);
    const DrivableLane lap = course.driven();
    expect_drivable(course, lap);
    EXPECT_EQ(lap.closed, track.closed);
    EXPECT_LT(sharpest(lap), bounds.sharpest_1pm);
    const double mean_length_m = 0.5 * (polyline_length_m(course.left(), track.closed) +
                                        polyline_length_m(course.right(), track.closed));
    EXPECT_NEAR(lap.length_m, mean_length_m, 0.05 * mean_length_m);
    SceneOptions options;
    options.false_positive_rates = {0.0};
    options.ranges_m = {30.0, 50.0};
    options.every_m = 3.3;
    constexpr double kEndsApart_m = 7.0;
    std::size_t one_sided = 0;
    std::size_t two_sided = 0;
    std::size_t short_lanes = 0;
    for (const AnnotatedScene& scene : generate_scenes(track, options)) {
        SCOPED_TRACE(scene.scene.id);
        const Course seen{scene.ground_truth.value(), scene.scene};
        // Where another leg is near, the evening of the far ends leaves a run that goes on there alone: no
        // lane.
        if (bounds.one_sided > 0 && (seen.left().back() - seen.right().back()).norm() > kEndsApart_m) {
            ++one_sided;
            continue;
        }
        ++two_sided;
        const DrivableLane lane = seen.driven();
        expect_drivable(seen, lane);
        EXPECT_LT(sharpest(lane), bounds.sharpest_1pm);
        const double shorter_m = std::min(polyline_length_m(seen.left()), polyline_length_m(seen.right()));
        if (lane.length_m > 0.75 * shorter_m - 4.0) continue;
        ++short_lanes;
        EXPECT_LE(short_lanes, bounds.short_lanes) << lane.length_m << " of " << shorter_m << " m";
    }
    EXPECT_LE(one_sided, bounds.one_sided) << " of " << two_sided;
}

TEST(DrivableLane, DrivesEveryGeneratedTrack) {
    for (const std::string& name : generated_track_names()) {
        // The walls between its legs are narrower than a lane may be wide.
        const DrivableBounds bounds{0.5, 0, name == "tight_hairpins" ? 23U : 0U};
        for (const std::uint64_t seed : {0U, 1U}) expect_drivable_track(generate_track(name, seed), bounds);
    }
}

TEST(DrivableLane, DrivesEveryRecordedTrack) {
    CONELANE_RECORDED_TRACKS_OR_SKIP(tracks);
    const std::map<std::string, DrivableBounds> peculiar{
        // Hairpins around a wall of 3 m that ends in a single cone: radii below 2 m.
        {"eufs_comp_2021", {0.6, 0, 14}},
        // The first right cone of one pose lies behind the tightest place of a bend.
        {"eufs_FSI", {0.5, 2, 0}},
    };
    for (const Track& track : tracks) {
        const auto bounds = peculiar.find(track.name);
        expect_drivable_track(track, bounds == peculiar.end() ? DrivableBounds{} : bounds->second);
    }
}

}  // namespace
}  // namespace conelane::experiments
