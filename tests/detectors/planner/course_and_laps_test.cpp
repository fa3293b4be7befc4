// The course that is known after a lap, and the lines at which laps count.

#include "detectors/planner/course_memory.hpp"
#include "detectors/planner/lap_counter.hpp"
#include "tests/support/planner_frames.hpp"
#include "tests/support/straight_line.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

using tests::DrivenCourse;

/// The middle of a course from the car on, `aside_m` to its left.
DrivableLane lane_ahead(const DrivenCourse& course, double s_m, double aside_m = 0.0,
                        double length_m = 12.0) {
    DrivableLane lane;
    for (double s = 0.0; s <= length_m + 1e-9; s += 0.5) {
        const Pose at = course.pose(s_m + s);
        const Point left(-std::sin(at.yaw_rad), std::cos(at.yaw_rad));
        lane.points.push_back({.s_m = s,
                               .position = at.position + aside_m * left,
                               .heading_rad = std::remainder(at.yaw_rad, 2.0 * std::numbers::pi),
                               .width_left_m = 1.75 - aside_m,
                               .width_right_m = 1.75 + aside_m});
    }
    lane.length_m = length_m;
    return lane;
}

class RecordedCourse : public testing::Test {
  protected:
    void drive(double from_m, double to_m, double aside_m = 0.0, double step_m = 0.6) {
        for (double s_m = from_m; s_m < to_m; s_m += step_m)
            memory_.record(lane_ahead(course_, s_m, aside_m), ConeMemory{});
    }
    DrivenCourse course_ = tests::oval(3);
    CourseMemory memory_{CourseSettings{}, 0.5};
};

TEST_F(RecordedCourse, IsClosedWhereTheLaneComesRound) {
    drive(0.0, course_.lap_m - 4.0);
    EXPECT_FALSE(memory_.closed());
    EXPECT_FALSE(memory_.course());
    EXPECT_TRUE(memory_.ahead(course_.pose(0.0), 20.0).points.empty());
    drive(course_.lap_m - 4.0, course_.lap_m + 3.0);
    ASSERT_TRUE(memory_.closed());
    const auto course = memory_.course();
    ASSERT_TRUE(course);
    EXPECT_TRUE(course->closed);
    EXPECT_NEAR(course->length_m, course_.lap_m, 0.5);
    // Points at equal steps around the course; the last one is one step before the first.
    const auto count = course->points.size();
    for (std::size_t i = 0; i < count; ++i) {
        const DrivablePoint& next = course->points[(i + 1) % count];
        EXPECT_NEAR((next.position - course->points[i].position).norm(),
                    course->length_m / static_cast<double>(count), 0.03)
            << i;
    }
    // The bends are left ones of 8 m.
    double turned_rad = 0.0;
    for (const DrivablePoint& point : course->points) {
        turned_rad += point.curvature_1pm * course->length_m / static_cast<double>(count);
        EXPECT_GT(point.curvature_1pm, -0.05);
        EXPECT_LT(point.curvature_1pm, 0.2);
    }
    EXPECT_NEAR(turned_rad, 2.0 * std::numbers::pi, 0.15);
}

TEST_F(RecordedCourse, KnowsWhatIsAheadOfTheCar) {
    drive(0.0, course_.lap_m + 3.0);
    const double s_m = course_.lap_m + 3.0;
    const DrivableLane ahead = memory_.ahead(course_.pose(s_m), 25.0);
    ASSERT_FALSE(ahead.points.empty());
    EXPECT_NEAR(ahead.length_m, 25.0, 6.0);
    EXPECT_LT(tests::farthest_from_middle_m(course_, s_m, ahead), 0.3);
    EXPECT_TRUE(memory_.ahead({{100.0, 50.0}, 0.0}, 25.0).points.empty()) << "the car is off it";
}

TEST_F(RecordedCourse, AParallelLegOrTheWayBackClosesNothing) {
    // The upper straight runs back 16 m beside the lower one, and a course that ends early is not
    // near.
    drive(0.0, 0.75 * course_.lap_m);
    EXPECT_FALSE(memory_.closed());
}

TEST_F(RecordedCourse, TheLastLapReplacesWhatWasThere) {
    drive(0.0, 1.2 * course_.lap_m);
    drive(1.2 * course_.lap_m, 2.4 * course_.lap_m, 0.6);  // a gate has moved the lane by 0.6 m
    const auto course = memory_.course();
    ASSERT_TRUE(course);
    EXPECT_NEAR(course->length_m, course_.lap_m, 5.0);
    for (const DrivablePoint& point : course->points) {
        EXPECT_NEAR(point.width_left_m, 1.15, 0.1) << point.s_m << ": of the lap before";
    }
}

TEST_F(RecordedCourse, AGapThatIsTooLongBeginsANewOne) {
    drive(0.0, 0.6 * course_.lap_m);
    drive(0.8 * course_.lap_m, course_.lap_m + 5.0);
    EXPECT_FALSE(memory_.closed());
    memory_.record(DrivableLane{}, ConeMemory{});  // no lane: nothing to record
    drive(course_.lap_m + 5.0, 1.9 * course_.lap_m);
    EXPECT_TRUE(memory_.closed()) << "a whole lap since the gap";
}

TEST_F(RecordedCourse, MovesWithTheMap) {
    drive(0.0, course_.lap_m + 3.0);
    memory_.move_along({{0.0, 0.0}, 0.0, {5.0, 0.0}});
    Pose there = course_.pose(3.0);
    there.position.x() += 5.0;
    EXPECT_FALSE(memory_.ahead(there, 20.0).points.empty());
}

class Laps : public testing::Test {
  protected:
    /// Returns the places at which laps counted.
    std::vector<double> drive(const DrivenCourse& course, double from_m, double to_m,
                              bool with_color = false) {
        std::vector<double> counted;
        for (double s_m = from_m; s_m < to_m; s_m += 0.6) {
            const int before = counter_.laps();
            (void)cones_.observe(tests::frame_at(course, s_m, 0.0, {.with_color = with_color}));
            counter_.observe(course.pose(s_m), lane_ahead(course, s_m), cones_);
            if (counter_.laps() > before) counted.push_back(s_m);
        }
        return counted;
    }
    ConeMemory cones_;
    LapCounter counter_{CourseSettings{}, 3};
};

TEST_F(Laps, AreCountedWhereTheRunBegan) {
    const DrivenCourse course = tests::oval(3);
    const auto counted = drive(course, 7.0, 3.2 * course.lap_m);
    ASSERT_EQ(counted.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
        const double line_m = 7.0 + static_cast<double>(i + 1) * course.lap_m;
        EXPECT_GE(counted[i], line_m - 1e-6);
        EXPECT_LT(counted[i], line_m + 0.7);
    }
    EXPECT_NEAR(counter_.since_line_m(), 0.2 * course.lap_m - 7.0, 1.5);
}

TEST_F(Laps, AreCountedAtTheGateOfOrangeConesWhereColorsSayIt) {
    const DrivenCourse course = tests::oval(3);
    const auto counted = drive(course, -7.0, 2.2 * course.lap_m, true);
    ASSERT_EQ(counted.size(), 2U) << "the gate at the start is no lap";
    EXPECT_NEAR(counted[0], course.lap_m + 0.3, 0.8);
    EXPECT_NEAR(counted[1], 2.0 * course.lap_m + 0.3, 0.8);
}

/// Small orange cones stand nearer, as where the course is closed between two events.
TEST_F(Laps, AreCountedAtTheGateOfBigOrangeConesBeforeOthers) {
    DrivenCourse course = tests::oval(3);
    std::ranges::for_each(course.cones.begin(), course.cones.begin() + 2,
                          [](Cone& cone) { cone.color = ConeColor::big_orange; });
    std::ranges::for_each(course.cones.end() - 2, course.cones.end(),
                          [](Cone& cone) { cone.color = ConeColor::orange; });
    const auto counted = drive(course, -7.0, 1.2 * course.lap_m, true);
    ASSERT_EQ(counted.size(), 1U);
    EXPECT_NEAR(counted[0], course.lap_m + 0.3, 0.8);
}

TEST_F(Laps, StandingOrRockingAtTheLineCountsNothing) {
    for (int i = 0; i < 400; ++i) {
        counter_.observe({{0.3 * std::sin(0.5 * i), 0.05 * std::cos(3.0 * i)}, 0.0}, DrivableLane{}, cones_);
    }
    EXPECT_EQ(counter_.laps(), 0);
}

TEST_F(Laps, TheLineIsPassedInItsDirectionAndInTheLaneOnly) {
    const auto at = [&](double x_m, double y_m, double yaw_rad) {
        counter_.observe({{x_m, y_m}, yaw_rad}, DrivableLane{}, cones_);
    };
    for (double x_m = 0.0; x_m < 40.0; x_m += 1.0) at(x_m, 0.0, 0.0);
    for (double x_m = 40.0; x_m > -20.0; x_m -= 1.0) at(x_m, 2.0, std::numbers::pi);  // back, over the line
    EXPECT_EQ(counter_.laps(), 0);
    for (double x_m = -20.0; x_m < 20.0; x_m += 1.0) at(x_m, 12.0, 0.0);  // another leg, 12 m aside
    EXPECT_EQ(counter_.laps(), 0);
    for (double x_m = 20.0; x_m > -20.0; x_m -= 1.0) at(x_m, 12.0, std::numbers::pi);
    for (double x_m = -20.0; x_m < 3.0; x_m += 1.0) at(x_m, 0.0, 0.0);
    EXPECT_EQ(counter_.laps(), 1);
    EXPECT_NEAR(counter_.since_line_m(), 2.0, 1e-9);
}

TEST_F(Laps, TheLineMovesWithTheMap) {
    const DrivenCourse course = tests::oval(2);
    (void)drive(course, 0.0, 0.5 * course.lap_m);
    counter_.move_along({{0.0, 0.0}, 0.0, {-2.0, 0.0}});
    const auto counted = drive(course, 0.5 * course.lap_m, course.lap_m + 5.0);
    ASSERT_EQ(counted.size(), 1U);
    EXPECT_NEAR(counted[0], course.lap_m - 2.0 + 0.3, 0.7);
}

}  // namespace
}  // namespace conelane
