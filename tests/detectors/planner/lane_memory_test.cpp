// What a planner keeps from frame to frame: stretches of lanes, the rest of the last path, and when a new
// lane replaces it.

#include "detectors/planner/lane_choice.hpp"
#include "detectors/planner/lane_stretch.hpp"
#include "model/geometry.hpp"
#include "tests/support/drivable_courses.hpp"
#include "tests/support/straight_line.hpp"

namespace conelane {
namespace {

using tests::straight_line;

TEST(LaneFoot, IsTheNearestPlaceThatRunsWithTheCar) {
    const DrivableLane lane = straight_line({0.0, 0.0}, 0.0, 10.0);
    const auto foot = foot_on(lane, {{3.2, 1.0}, 0.4}, 0.0, 10.0);
    ASSERT_TRUE(foot);
    EXPECT_NEAR(foot->s_m, 3.2, 1e-9);
    EXPECT_NEAR(foot->offset_m, 1.0, 1e-9);
    EXPECT_FALSE(foot_on(lane, {{3.2, 1.0}, std::numbers::pi}, 0.0, 10.0)) << "the car drives against it";
    EXPECT_NEAR(foot_on(lane, {{3.2, 1.0}, 0.0}, 5.0, 10.0)->s_m, 5.0, 0.5 + 1e-9)
        << "within what is asked for, to a segment";
}

TEST(Turn, IsInTheHalfOpenRange) {
    EXPECT_EQ(turn_rad(0.0, -std::numbers::pi), std::numbers::pi);
    EXPECT_EQ(turning_angle({1.0, 0.0}, {-1.0, -1e-20}), std::numbers::pi);
}

TEST(Stretch, IsCutToStepsAndGoesRoundAClosedLane) {
    const DrivableLane lane = straight_line({0.0, 0.0}, 0.0, 10.0);
    const DrivableLane part = stretch(lane, 2.25, 7.0, 0.5);
    ASSERT_EQ(part.points.size(), 10U);
    EXPECT_NEAR(part.points[0].position.x(), 2.25, 1e-9);
    EXPECT_EQ(part.points[0].s_m, 0.0);
    EXPECT_NEAR(part.points[9].position.x(), 6.75, 1e-9);
    EXPECT_TRUE(stretch(lane, 9.8, 20.0, 0.5).points.empty()) << "shorter than a step";
    EXPECT_TRUE(stretch(DrivableLane{}, 0.0, 5.0, 0.5).points.empty());

    DrivableLane ring = tests::circle(10.0, 1.0, 2.0, 2.0 * tests::kPi, true).driven();
    ASSERT_TRUE(ring.closed);
    const DrivableLane around = stretch(ring, ring.length_m - 3.0, ring.length_m + 3.0, 0.5);
    EXPECT_FALSE(around.closed);
    EXPECT_NEAR(around.length_m, 6.0, 0.5);
    EXPECT_LT((around.points[6].position - ring.points.front().position).norm(), 0.05);
}

TEST(Jump, IsHowFarTwoLanesAreApartNearTheCar) {
    const DrivableLane lane = straight_line({0.0, 0.0}, 0.0, 20.0);
    EXPECT_NEAR(jump_m(lane, straight_line({0.0, 0.7}, 0.0, 20.0), 8.0), 0.7, 0.01);
    EXPECT_NEAR(jump_m(lane, straight_line({0.0, 0.0}, 0.1, 20.0), 8.0), 8.0 * std::sin(0.1), 0.06);
    EXPECT_NEAR(jump_m(lane, straight_line({-3.0, 0.0}, 0.0, 20.0), 8.0), 0.0, 0.01) << "along is no jump";
}

TEST(Common, IsHowFarTwoLanesRunTogether) {
    const DrivableLane lane = straight_line({0.0, 0.0}, 0.0, 20.0);
    EXPECT_NEAR(common_m(lane, straight_line({0.0, 0.5}, 0.0, 12.0), 0.9, 8.0), 11.0, 0.51)
        << "to the end of the shorter one";
    EXPECT_NEAR(common_m(lane, straight_line({0.0, 0.0}, 0.1, 20.0), 0.9, 8.0), 0.9 / std::sin(0.1), 0.51);
    EXPECT_EQ(common_m(lane, straight_line({0.0, 2.0}, 0.0, 20.0), 0.9, 8.0), 0.0);
    EXPECT_EQ(common_m(lane, DrivableLane{}, 0.9, 8.0), 0.0);
}

TEST(BegunAtCar, ALaneThatBeginsAheadIsJoinedToTheCar) {
    const DrivableLane ahead = straight_line({5.0, 0.0}, 0.0, 10.0);
    const Pose car{{0.0, 0.6}, 0.0};
    const auto lane = begun_at_car(ahead, car, nullptr, 0.5);
    ASSERT_TRUE(lane);
    EXPECT_LT((lane->points.front().position - car.position).norm(), 0.01);
    EXPECT_NEAR(lane->length_m, 15.0, 0.6);
    for (std::size_t i = 1; i < lane->points.size(); ++i) {
        EXPECT_NEAR((lane->points[i].position - lane->points[i - 1].position).norm(), 0.5, 0.01) << i;
        EXPECT_LT(std::abs(lane->points[i].heading_rad - lane->points[i - 1].heading_rad), 0.2) << i;
    }
    EXPECT_FALSE(begun_at_car(straight_line({30.0, 0.0}, 0.0, 10.0), car, nullptr, 0.5)) << "too far ahead";
    EXPECT_FALSE(begun_at_car(straight_line({0.0, 20.0}, 0.0, 10.0), car, nullptr, 0.5)) << "far beside it";
    EXPECT_FALSE(begun_at_car(DrivableLane{}, car, nullptr, 0.5));
}

TEST(BegunAtCar, ALaneThatLiesAsideIsNotJoined) {
    const Pose car{{0.0, 0.0}, 0.0};
    EXPECT_FALSE(begun_at_car(straight_line({4.0, 9.0}, 0.0, 10.0), car, nullptr, 0.5));
    EXPECT_FALSE(begun_at_car(straight_line({5.0, -5.0}, 0.5, 10.0), car, nullptr, 0.5));
    EXPECT_TRUE(begun_at_car(straight_line({5.0, 3.0}, 0.5, 10.0), car, nullptr, 0.5))
        << "in a bend it begins a little aside";
    EXPECT_TRUE(begun_at_car(straight_line({3.7, -4.8}, -1.7, 10.0), car, nullptr, 0.5))
        << "behind a hairpin";
    EXPECT_FALSE(begun_at_car(straight_line({3.7, -4.8}, 1.7, 10.0), car, nullptr, 0.5)) << "it leads back";
    EXPECT_FALSE(begun_at_car(straight_line({0.5, 7.0}, 3.0, 10.0), car, nullptr, 0.5)) << "the other leg";
    EXPECT_FALSE(begun_at_car(straight_line({2.0, 5.0}, 1.9, 10.0), car, nullptr, 0.5))
        << "a bend too narrow";
}

TEST(BegunAtCar, AlongTheLaneThatLeadsThere) {
    // The lane so far bends to where the new one begins; straight from the car would cut the bend.
    const DrivableLane before = tests::circle(8.0, 1.0, 2.0, 2.5, false).driven();
    const DrivableLane ahead = stretch(before, 9.0, before.length_m, 0.5);
    const auto lane = begun_at_car(ahead, {{0.0, 0.0}, 0.0}, &before, 0.5);
    ASSERT_TRUE(lane);
    for (const DrivablePoint& point : lane->points) {
        EXPECT_NEAR((point.position - Point(0.0, 8.0)).norm(), 8.0, 0.2) << point.s_m;
    }
}

TEST(Extended, ALaneGoesOnWhereTheOtherKnowsMore) {
    const DrivableLane shorter = straight_line({0.0, 0.0}, 0.0, 6.0);
    EXPECT_NEAR(extended(shorter, straight_line({2.0, 0.2}, 0.0, 15.0), 0.5).length_m, 17.0, 0.6);
    EXPECT_NEAR(extended(shorter, straight_line({2.0, 3.0}, 0.0, 15.0), 0.5).length_m, 6.0, 1e-9);
    EXPECT_NEAR(extended(shorter, straight_line({6.0, 0.0}, 1.5, 15.0), 0.5).length_m, 6.0, 1e-9);
}

class RememberedPath : public testing::Test {
  protected:
    PathMemory path_{LaneChoiceSettings{}, 0.5, 1.0};
};

TEST_F(RememberedPath, IsCutAtTheCarAndEndsWhereItEnded) {
    EXPECT_TRUE(path_.left({}, 0.0).points.empty());
    path_.remember(straight_line({0.0, 0.0}, 0.0, 20.0), 10.0);
    const DrivableLane left = path_.left({{3.0, 0.4}, 0.0}, 10.5);
    EXPECT_NEAR(left.points.front().position.x(), 3.0, 1e-9);
    EXPECT_NEAR(left.length_m, 17.0, 1e-9);
    ASSERT_TRUE(left.trusted_m);
    EXPECT_NEAR(*left.trusted_m, 17.0, 1e-9) << "trusted as far as it was, seen from the car";
    EXPECT_EQ(path_.time_s(), 10.0);
}

TEST_F(RememberedPath, IsNoneWhereItIsOldOrTheCarIsOffItOrAtItsEnd) {
    const DrivableLane lane = straight_line({0.0, 0.0}, 0.0, 20.0);
    path_.remember(lane, 0.0);
    EXPECT_TRUE(path_.left({{1.0, 5.0}, 0.0}, 0.1).points.empty()) << "5 m aside";
    EXPECT_TRUE(path_.left({{1.0, 0.0}, 3.0}, 0.1).points.empty()) << "against it";
    EXPECT_FALSE(path_.left({{1.0, 0.0}, 0.0}, 1.0).points.empty());
    EXPECT_TRUE(path_.left({{1.0, 0.0}, 0.0}, 1.1).points.empty()) << "too old";
    EXPECT_TRUE(path_.left({{1.0, 0.0}, 0.0}, 0.5).points.empty()) << "and gone for good";
    path_.remember(straight_line({0.0, 0.0}, 0.0, 4.0), 2.0);
    EXPECT_FALSE(path_.left({{3.0, 0.0}, 0.0}, 2.1).points.empty());
    EXPECT_TRUE(path_.left({{3.9, 0.0}, 0.0}, 2.2).points.empty()) << "at its end";
}

TEST_F(RememberedPath, TheOtherLegMayBeNearer) {
    // The lane runs out along y = 0 and back along y = 6. The car is 2.9 m beside the first leg and 3.1 m
    // from the second; from the place at 2.4 m along the lane, it can only be on the first.
    DrivableLane lane =
        tests::beside_path([](double s) { return s > 8.0 && s < 8.0 + 3.0 * tests::kPi ? 1.0 / 3.0 : 0.0; },
                           30.0, 1.0, 1.5)
            .driven();
    path_.remember(lane, 0.0);
    const DrivableLane left = path_.left({{2.4, 2.0}, 0.0}, 0.1);
    ASSERT_FALSE(left.points.empty());
    EXPECT_LT(std::abs(left.points.front().position.y()), 0.2);
}

TEST_F(RememberedPath, MovesWithTheMap) {
    path_.remember(straight_line({0.0, 0.0}, 0.0, 20.0), 0.0);
    path_.move_along({{0.0, 0.0}, 0.0, {0.0, 0.5}});
    EXPECT_NEAR(path_.left({{3.0, 0.5}, 0.0}, 0.1).points.front().position.y(), 0.5, 1e-9);
}

TEST(LaneChoice, OneWrongFrameIsNotDrivenByAndTwoThatAgreeAre) {
    LaneChoice choice{LaneChoiceSettings{}};
    const DrivableLane lane = straight_line({0.0, 0.0}, 0.0, 20.0);
    const DrivableLane other = straight_line({0.0, 0.0}, 0.6, 20.0);
    const DrivableLane third = straight_line({0.0, 0.0}, -0.6, 20.0);
    EXPECT_TRUE(choice.take(lane, DrivableLane{})) << "there is none to hold it back";
    EXPECT_TRUE(choice.take(lane, lane));
    EXPECT_TRUE(choice.take(straight_line({0.0, 0.2}, 0.0, 20.0), lane)) << "noise";
    EXPECT_FALSE(choice.take(other, lane));
    EXPECT_TRUE(choice.take(lane, lane));
    EXPECT_FALSE(choice.take(other, lane));
    EXPECT_FALSE(choice.take(third, lane)) << "they do not agree";
    EXPECT_TRUE(choice.take(lane, lane));
}

TEST(LaneChoice, ALaneNearItsEndDoesNotResist) {
    LaneChoice choice{LaneChoiceSettings{}};
    const DrivableLane lane = straight_line({0.0, 0.0}, 0.0, 20.0);
    for (int i = 0; i < 5; ++i) (void)choice.take(lane, i == 0 ? DrivableLane{} : lane);
    EXPECT_TRUE(choice.take(straight_line({0.0, 0.0}, 0.6, 20.0), straight_line({0.0, 0.0}, 0.0, 1.0)));
}

}  // namespace
}  // namespace conelane
