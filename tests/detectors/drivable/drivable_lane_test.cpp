
#include "tests/support/drivable_checks.hpp"

namespace conelane::tests {
namespace {

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
                // Near its ends, an open line continues as a circle for some metres.
                const bool at_end = point.s_m < 3.5 || point.s_m > lane.length_m - 3.5;
                EXPECT_NEAR(point.curvature_1pm, curvature(point.s_m), at_end ? 0.03 : 0.008) << point.s_m;
            }
        }
    }
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
        const Pose turned{.yaw_rad = angle};
        const auto rotated = [&](const Point& place) {
            return place.x() * turned.heading() +
                   place.y() * Point(-turned.heading().y(), turned.heading().x());
        };
        Course moved = course;
        for (Cone& cone : moved.scene.cones) cone.position = rotated(cone.position) + shift;
        moved.scene.pose = {shift, angle};
        const DrivableLane other = moved.driven();
        ASSERT_EQ(other.points.size(), lane.points.size());
        for (std::size_t i = 0; i < lane.points.size(); ++i) {
            const DrivablePoint& a = lane.points[i];
            const DrivablePoint& b = other.points[i];
            EXPECT_LT((rotated(a.position) + shift - b.position).norm(), 1e-6);
            EXPECT_NEAR(std::remainder(a.heading_rad + angle - b.heading_rad, 2.0 * kPi), 0.0, 1e-6);
            EXPECT_NEAR(a.curvature_1pm, b.curvature_1pm, 1e-6);
            EXPECT_NEAR(a.width_left_m, b.width_left_m, 1e-6);
        }
    }
}

TEST(DrivableLane, StartsOnTheLegOfAHairpinThatRunsTheCarsWay) {
    // The lane runs out along y = 0 and back along y = 4.4. The car is nearer to the way back, but its
    // heading is that of the way out.
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
    for (std::size_t i = 0; i < course.scene.cones.size(); i += 3) {  // wider at some places
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

TEST(DrivableLane, PassesOnHowFarTheDetectorTrustsALane) {
    const Course course = straight(range(0.0, 20.0, 4.0), range(0.0, 20.0, 4.0));
    LaneAnswer answer{.status = LaneStatus::found, .lane = course.lane};
    EXPECT_EQ(drivable(answer, course.scene).trusted_m, std::nullopt);
    answer.trusted_m = 12.5;
    EXPECT_EQ(drivable(answer, course.scene).trusted_m, 12.5);
    EXPECT_EQ(drivable(answer, course.scene).points.size(), 41U);
    answer.trusted_m = 50.0;
    EXPECT_NEAR(drivable(answer, course.scene).trusted_m.value(), 20.0, 0.1);
    answer.status = LaneStatus::stopped;
    EXPECT_TRUE(drivable(answer, course.scene).points.empty());
}

}  // namespace
}  // namespace conelane::tests
