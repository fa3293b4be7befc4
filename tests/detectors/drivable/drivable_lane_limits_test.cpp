// Limits of a centre line: too narrow places, corners that it would cut, and lanes that turn back.

#include "conelane/drivable_lane.hpp"
#include "tests/support/refusal.hpp"

namespace conelane {
namespace {

/// Boundaries as a scene; the car is at the origin and looks along +x.
struct Boundaries {
    Lane lane;
    Scene scene;

    Boundaries(const std::vector<Point>& left, const std::vector<Point>& right) {
        for (const auto& [points, ids] : {std::pair(&left, &lane.left), std::pair(&right, &lane.right)}) {
            for (const Point& point : *points) {
                ids->push_back(static_cast<ConeId>(scene.cones.size()));
                scene.cones.push_back({.id = ids->back(), .position = point});
            }
        }
    }
};

/// Both boundaries beside the x axis: y at each x, and its negative.
Boundaries about_the_axis(const std::vector<Point>& left) {
    return {left, mapped(left, [](const Point& point) { return Point(point.x(), -point.y()); })};
}

TEST(DrivableLaneLimits, ALaneBelowEightyCentimetresIsUnusable) {
    const Boundaries wide = about_the_axis({{0, 0.45}, {4, 0.45}, {8, 0.45}});
    EXPECT_NEAR(drivable(wide.lane, wide.scene).length_m, 8.0, 1e-6);
    const Boundaries narrow = about_the_axis({{0, 0.35}, {4, 0.35}, {8, 0.35}});
    const DrivableLane lane = drivable(narrow.lane, narrow.scene);
    EXPECT_EQ(lane.length_m, 0.0);
    EXPECT_TRUE(lane.points.empty());
}

/// 0.6 m wide up to x = 2, then wider by 0.6 m each metre. Rungs are 0.25 m apart, and 0.4 m from the middle
/// to either boundary are reached at x = 2.39, between two of them.
TEST(DrivableLaneLimits, ALaneThatIsUnusableAtTheCarHasNoPoints) {
    Boundaries funnel = about_the_axis({{0, 0.3}, {2, 0.3}, {6, 1.5}, {24, 1.5}});
    funnel.scene.pose.position.x() = 2.3;
    const DrivableLane none = drivable(funnel.lane, funnel.scene);
    EXPECT_EQ(none.length_m, 0.0);
    EXPECT_TRUE(none.points.empty());
    funnel.scene.pose.position.x() = 2.6;
    EXPECT_NEAR(drivable(funnel.lane, funnel.scene).length_m, 24.0 - 2.6, 0.01);
}

/// A right angle of a lane 2.4 m wide: the line may be up to 0.95 m from the middle. This smoothing alone
/// would move it farther.
TEST(DrivableLaneLimits, SmoothingCutsNoCornerOfTheLane) {
    const Boundaries corner({{0, 1.2}, {5, 1.2}, {10, 1.2}, {10, 6}, {10, 11}, {10, 16}},
                            {{0, -1.2}, {6, -1.2}, {12.4, -1.2}, {12.4, 5}, {12.4, 10}, {12.4, 16}});
    const DrivableLane lane = drivable(corner.lane, corner.scene, {.smoothing_m = 5.0});
    ASSERT_FALSE(lane.points.empty());
    EXPECT_GT(lane.points.back().position.y(), 15.0);
    EXPECT_NEAR(lane.points.back().position.x(), 11.2, 0.95);
}

TEST(DrivableLaneLimits, AConeThatIsInTheLaneTwiceIsNamedAsThat) {
    Boundaries twice = about_the_axis({{0, 2}, {4, 2}, {8, 2}});
    twice.lane.right.back() = twice.lane.left[1];
    const auto call = [&] { (void)drivable(twice.lane, twice.scene); };
    EXPECT_EQ(refused_key(call), "right[2]");
    EXPECT_THAT(refusal(call), testing::HasSubstr("cone 1 is in the lane twice"));
}

/// Both boundaries turn back for a stretch before they continue. With steps of 100 m, only the first point of
/// the centre line shows it.
TEST(DrivableLaneLimits, ALaneEndsWhereItTurnsBack) {
    for (const double back_m : {1.0, 1.5, 2.0, 3.0}) {
        for (const double turn_at_m : {10.0, 10.1, 10.2}) {
            SCOPED_TRACE(testing::Message() << back_m << " m back from " << turn_at_m << " m");
            const Boundaries zigzag = about_the_axis({{0, 1.75},
                                                      {5, 1.75},
                                                      {turn_at_m, 1.75},
                                                      {turn_at_m - back_m, 1.75},
                                                      {15, 1.75},
                                                      {20, 1.75}});
            const DrivableLane lane =
                drivable(zigzag.lane, zigzag.scene, {.step_m = 100.0, .smoothing_m = 0.25});
            EXPECT_GT(lane.length_m, 9.5);
            EXPECT_LT(lane.length_m, turn_at_m);
        }
    }
}

}  // namespace
}  // namespace conelane
