#include "evaluation/scoring/score.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

/// Boundaries 3 m apart along +x, `offset_m` to the left, cones every 4 m.
LaneOutline straight(double offset_m, double from_m, double to_m) {
    LaneOutline lane;
    for (double x = from_m; x <= to_m; x += 4.0) {
        lane.left.emplace_back(x, offset_m + 1.5);
        lane.right.emplace_back(x, offset_m - 1.5);
    }
    return lane;
}

const Pose kCar{{0, 0}, 0.0};

TEST(CentreLineError, IsZeroOfTheSameLane) {
    const CentreLine line = centre_line_of(straight(0, 0, 40), kCar);
    ASSERT_EQ(line.size(), 51u) << "25 m in steps of half a metre";
    const CentreLineError error = centre_line_error(line, line);
    EXPECT_EQ(error.lateral_m.size(), 41u) << "20 m";
    EXPECT_THAT(error.lateral_m, testing::Each(testing::FloatNear(0.0F, 1e-6F)));
    EXPECT_NEAR(error.heading_rad.value(), 0.0, 1e-9);
}

TEST(CentreLineError, IsTheOffsetOfAParallelLane) {
    const CentreLine truth = centre_line_of(straight(0, 0, 40), kCar);
    const CentreLineError error = centre_line_error(centre_line_of(straight(0.3, 0, 40), kCar), truth);
    EXPECT_EQ(error.lateral_m.size(), 41u);
    EXPECT_THAT(error.lateral_m, testing::Each(testing::FloatNear(0.3F, 1e-4F)));
    EXPECT_NEAR(error.heading_rad.value(), 0.0, 1e-6);
}

TEST(CentreLineError, TakesTheHeadingAtTenMetres) {
    const CentreLine truth = centre_line_of(straight(0, 0, 40), kCar);
    const double turn_rad = 0.05;
    LaneOutline turned = straight(0, 0, 40);
    for (std::vector<Point>* side : {&turned.left, &turned.right}) {
        for (Point& vertex : *side) {
            vertex = {vertex.x() * std::cos(turn_rad) - vertex.y() * std::sin(turn_rad),
                      vertex.x() * std::sin(turn_rad) + vertex.y() * std::cos(turn_rad)};
        }
    }
    const CentreLineError error = centre_line_error(centre_line_of(turned, kCar), truth);
    EXPECT_NEAR(error.heading_rad.value(), turn_rad, 1e-6);
    EXPECT_NEAR(error.lateral_m[20], 10.0 * std::sin(turn_rad), 0.02);
}

TEST(CentreLineError, TheTrueHeadingTurnsEvenlyBetweenTwoPoints) {
    CentreLine truth;
    CentreLine lane;  // a quarter of a step further on, and turning five times as fast
    for (int i = 0; i < 30; ++i) {
        truth.push_back({{0.5 * i, 0.0}, 0.02 * i});
        lane.push_back({{0.5 * i + 0.125, 0.0}, 0.1 * i});
    }
    const CentreLineError error = centre_line_error(lane, truth);
    EXPECT_NEAR(error.heading_rad.value(), 0.1 * 20 - 0.02 * 20.25, 1e-9) << "point 20 is at 10 m";
}

TEST(CentreLineError, CountsOnlyWhatBothCover) {
    const CentreLine truth = centre_line_of(straight(0, 0, 8), kCar);
    const CentreLineError error = centre_line_error(centre_line_of(straight(0, 0, 40), kCar), truth);
    EXPECT_EQ(error.lateral_m.size(), 17u) << "8 m";
    EXPECT_FALSE(error.heading_rad) << "the true line ends before 10 m";
    EXPECT_TRUE(centre_line_error({}, truth).lateral_m.empty());
    EXPECT_TRUE(centre_line_error(truth, {}).lateral_m.empty());
}

TEST(CentreLine, OfAPolylineStartsBesideTheCarAndHasEqualSteps) {
    const std::vector<Point> polyline{{-5, 0}, {2, 0}, {2, 10}};
    const CentreLine line = centre_line_of(polyline, {{1, 0.2}, 0.0}, 3.0);
    ASSERT_EQ(line.size(), 7u);
    EXPECT_NEAR((line[0].position - Point(1, 0)).norm(), 0.0, 1e-12);
    EXPECT_NEAR((line[2].position - Point(2, 0)).norm(), 0.0, 1e-9);
    EXPECT_NEAR((line[6].position - Point(2, 2)).norm(), 0.0, 1e-9);
    EXPECT_NEAR(line[6].heading_rad, std::numbers::pi / 2, 1e-12);
    EXPECT_TRUE(centre_line_of(std::vector<Point>{{0, 0}}, kCar, 3.0).empty());
}

TEST(Steady, ComparesTheFirstFifteenMetresThatBothCover) {
    const CentreLine before = centre_line_of(straight(0, 0, 40), kCar);
    const Pose next{{2, 0}, 0.0};
    EXPECT_TRUE(is_steady(before, centre_line_of(straight(0.4, 0, 40), next)));
    EXPECT_FALSE(is_steady(before, centre_line_of(straight(0.6, 0, 40), next)));

    LaneOutline bends_late = straight(0, 0, 40);  // leaves the other one between 20 and 24 m
    for (std::vector<Point>* side : {&bends_late.left, &bends_late.right}) {
        for (std::size_t i = 6; i < side->size(); ++i) (*side)[i].y() += 3.0;
    }
    EXPECT_TRUE(is_steady(before, centre_line_of(bends_late, next))) << "past the first 15 m";
    EXPECT_FALSE(is_steady(before, centre_line_of(bends_late, {{8, 0}, 0.0})));
    EXPECT_FALSE(is_steady(before, {})) << "no lane is no steady one";
    EXPECT_FALSE(is_steady({}, before));
}

}  // namespace
}  // namespace conelane
