// The geometry of acceleration and skidpad, compared with numbers computed by hand from the rules.

#include "detectors/planner/known_course.hpp"
#include "tests/detectors/planner/known_event.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kCircle_m = kPi * 18.25;

TEST(KnownCourse, ConesOfTheRulesStandOnTheBoundaries) {
    const KnownCourse skidpad = known_course(Mission::skidpad);
    for (const Point& cone : known_event::skidpad_cones()) {
        const auto contact = skidpad.boundary_at(cone, 0.0, 0.5);
        ASSERT_TRUE(contact) << testing::PrintToString(cone);
        EXPECT_NEAR(contact->off_m, 0.0, 1e-9) << testing::PrintToString(cone);
    }
    const KnownCourse acceleration = known_course(Mission::acceleration);
    for (const double half_m : {1.5, 1.9, 2.5}) {
        for (const Point& cone : known_event::acceleration_cones(half_m)) {
            const auto contact = acceleration.boundary_at(cone, half_m - 1.5, 0.5);
            ASSERT_TRUE(contact) << testing::PrintToString(cone);
            EXPECT_NEAR(contact->off_m, 0.0, 1e-9) << testing::PrintToString(cone);
        }
    }
}

TEST(KnownCourse, TheMiddleOfTheLaneTouchesNoBoundaryOfItsOwn) {
    // The boundaries are 1.5 m to either side of the route; there is none within 1.4 m, except the inner
    // circles where both lanes cross the entry.
    const KnownCourse skidpad = known_course(Mission::skidpad);
    for (double s_m = -15.0; s_m < 4.0 * kCircle_m + 20.0; s_m += 0.5) {
        const Point place = skidpad.at(s_m).position;
        EXPECT_FALSE(skidpad.boundary_at(place, 0.0, 1.4)) << s_m;
    }
}

TEST(KnownCourse, AWiderLaneHasItsBoundariesFartherOut) {
    const KnownCourse skidpad = known_course(Mission::skidpad);
    // Right circle: inner boundary at 7.625 m, outer at 10.625 m of (0, -9.125).
    const auto inner = skidpad.boundary_at({0.0, -9.125 - 7.425}, 0.2, 0.1);
    ASSERT_TRUE(inner);
    EXPECT_NEAR(inner->off_m, 0.0, 1e-12);
    EXPECT_NEAR(inner->normal.y(), -1.0, 1e-12);
    EXPECT_EQ(inner->color, ConeColor::yellow);
    const auto outer = skidpad.boundary_at({0.0, -9.125 - 10.925}, 0.2, 0.2);
    ASSERT_TRUE(outer);
    EXPECT_NEAR(outer->off_m, 0.1, 1e-12);
    EXPECT_EQ(outer->color, ConeColor::blue);
    EXPECT_EQ(skidpad.boundary_at({0.0, 9.125 + 7.625}, 0.0, 0.1)->color, ConeColor::blue);
    const KnownCourse acceleration = known_course(Mission::acceleration);
    EXPECT_NEAR(acceleration.boundary_at({30.0, -2.0}, 0.4, 0.2)->off_m, -0.1, 1e-12);
    EXPECT_FALSE(acceleration.boundary_at({30.0, -2.0}, 0.0, 0.4));
}

TEST(KnownCourse, TheOuterCircleIsOpenTowardsTheOtherLanes) {
    const KnownCourse skidpad = known_course(Mission::skidpad);
    // Where the outer right circle crosses the x axis: (+-5.44, 0).
    const double x_m = std::sqrt(10.625 * 10.625 - 9.125 * 9.125);
    EXPECT_FALSE(skidpad.boundary_at({x_m, 0.0}, 0.0, 0.5));
    EXPECT_FALSE(skidpad.boundary_at({-x_m, 0.0}, 0.0, 0.5));
    // Its farthest place in the left circle: (0, 1.5) is the left inner boundary, not the right outer one.
    const auto contact = skidpad.boundary_at({0.0, 1.5}, 0.0, 0.1);
    ASSERT_TRUE(contact);
    EXPECT_EQ(contact->color, ConeColor::blue);
}

TEST(KnownCourse, TheRouteOfTheSkidpadIsRightTwiceLeftTwiceStraightOn) {
    const KnownCourse skidpad = known_course(Mission::skidpad);
    EXPECT_NEAR(skidpad.finish_s_m, 229.336, 1e-3);  // 4 pi 18.25
    const auto expect = [&](double s_m, double x_m, double y_m, double heading_rad, double curvature_1pm) {
        const DrivablePoint point = skidpad.at(s_m);
        EXPECT_NEAR(point.position.x(), x_m, 1e-9) << s_m;
        EXPECT_NEAR(point.position.y(), y_m, 1e-9) << s_m;
        EXPECT_NEAR(std::remainder(point.heading_rad - heading_rad, 2.0 * kPi), 0.0, 1e-9) << s_m;
        EXPECT_NEAR(point.curvature_1pm, curvature_1pm, 1e-12) << s_m;
    };
    expect(-15.0, -15.0, 0.0, 0.0, 0.0);
    expect(0.25 * kCircle_m, 9.125, -9.125, -kPi / 2.0, -1.0 / 9.125);
    expect(1.5 * kCircle_m, 0.0, -18.25, kPi, -1.0 / 9.125);
    expect(2.25 * kCircle_m, 9.125, 9.125, kPi / 2.0, 1.0 / 9.125);
    expect(3.75 * kCircle_m, -9.125, 9.125, -kPi / 2.0, 1.0 / 9.125);
    expect(4.0 * kCircle_m + 12.0, 12.0, 0.0, 0.0, 0.0);
}

TEST(KnownCourse, TheRouteHasNoStep) {
    for (const Mission mission : {Mission::acceleration, Mission::skidpad}) {
        const KnownCourse course = known_course(mission);
        for (double s_m = -10.0; s_m < course.end_s_m; s_m += 0.01) {
            const double step_m = (course.at(s_m + 0.01).position - course.at(s_m).position).norm();
            ASSERT_NEAR(step_m, 0.01, 1e-6) << s_m;
        }
    }
}

TEST(KnownCourse, PhasesAndLapsComeInOrder) {
    const KnownCourse skidpad = known_course(Mission::skidpad);
    std::vector<std::string> phases;
    int laps = 0;
    for (double s_m = -16.0; s_m < 250.0; s_m += 0.1) {
        const std::string phase(skidpad.phase(s_m));
        if (phases.empty() || phases.back() != phase) phases.push_back(phase);
        EXPECT_GE(skidpad.laps(s_m), laps);
        laps = skidpad.laps(s_m);
    }
    EXPECT_THAT(phases, testing::ElementsAre("approach", "right 1", "right 2", "left 1", "left 2", "exit"));
    EXPECT_EQ(laps, 4);
    EXPECT_EQ(skidpad.phase(2.0 * kCircle_m - 0.01), "right 2");
    EXPECT_EQ(skidpad.phase(2.0 * kCircle_m + 0.01), "left 1");
    const KnownCourse acceleration = known_course(Mission::acceleration);
    EXPECT_EQ(acceleration.phase(30.0), "");
    EXPECT_EQ(acceleration.laps(100.0), 0);
    EXPECT_EQ(acceleration.finish_s_m, 75.0);
    EXPECT_EQ(acceleration.end_s_m, 175.0);
}

}  // namespace
}  // namespace conelane
