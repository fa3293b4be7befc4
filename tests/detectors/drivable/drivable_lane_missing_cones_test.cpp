#include "tests/support/drivable_checks.hpp"

namespace conelane::tests {
namespace {

TEST(DrivableLane, KeepsItsWidthWhereOneBoundaryEndsFirst) {
    // The longer boundary counts within 6.5 m of the other one's end, half of it for the middle.
    const Course longer_right = straight({0.0, 4.0}, range(0.0, 28.0, 4.0));
    const double beyond_m = std::sqrt(6.5 * 6.5 - 3.5 * 3.5);
    for (const Course& course : {longer_right, straight(range(0.0, 28.0, 4.0), {0.0, 4.0})}) {
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
    // The outer boundary ends in the hairpin, and the inner one comes back. Seen from the end of the outer
    // one, the way back is not part of the lane.
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

TEST(DrivableLane, InfersABoundaryOfWhichNoConeIsKnown) {
    for (const bool on_left : {true, false}) {
        SCOPED_TRACE(on_left);
        const double side = on_left ? 1.0 : -1.0;
        Course course = straight(range(1.0, 25.0, 4.0), range(1.0, 25.0, 4.0));
        (on_left ? course.lane.right : course.lane.left).clear();
        for (const double width_m : {3.0, 3.5, 4.5}) {
            const DrivableLane lane = course.driven({.default_width_m = width_m});
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

TEST(DrivableLane, MarksGapsThatAConeIsMissingIn) {
    Course course = straight({0.0, 4.0, 12.0, 16.0, 20.0}, range(0.0, 20.0, 4.0));
    course.scene.pose.position = {2.0, 0.0};
    DrivableLane lane = course.driven();
    ASSERT_EQ(lane.bridged.size(), 1U);
    EXPECT_TRUE(lane.bridged[0].on_left);
    EXPECT_NEAR(lane.bridged[0].from_s_m, 2.0, 0.6);
    EXPECT_NEAR(lane.bridged[0].to_s_m, 10.0, 0.6);
    EXPECT_TRUE(course.driven({.max_gap_m = 8.5}).bridged.empty());
    EXPECT_EQ(course.driven({.max_gap_m = 3.9}).bridged.size(), 9U);
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

}  // namespace
}  // namespace conelane::tests
