#include "model/geometry.hpp"

#include "tests/support/testing.hpp"

#include <Eigen/Core>

namespace conelane {
namespace {

constexpr double kPi = std::numbers::pi;

/// To the last bit, so that no answer depends on which of the two a caller uses.
TEST(Point, ConvertsFromAndToVectorsOfEigenAndComputesLikeThem) {
    boost::random::mt19937_64 random(1);
    boost::random::uniform_real_distribution<double> any(-10.0, 10.0);
    for (int k = 0; k < 1000; ++k) {
        const Eigen::Vector2d a(any(random), any(random));
        const Eigen::Vector2d b(any(random), any(random));
        const Point p = a;
        const Point q(b.x(), b.y());
        const double factor = any(random);
        EXPECT_EQ(Point(a + factor * b), p + factor * q);
        EXPECT_EQ(Point(a - b / factor), p - q / factor);
        EXPECT_EQ(a.dot(b), p.dot(q));
        EXPECT_EQ(a.norm(), p.norm());
        EXPECT_EQ(Point(a.normalized()), p.normalized());
        EXPECT_EQ(Point(a.cwiseMin(b)), p.cwiseMin(q));
        EXPECT_EQ(a.cwiseAbs().maxCoeff(), p.cwiseAbs().maxCoeff());
        const Eigen::Vector2d back = p;
        EXPECT_EQ(back, a);
    }
    EXPECT_EQ(Point().normalized(), Point(0, 0));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(std::isnan(Point(nan, 1.0).maxCoeff()) && std::isnan(Point(1.0, nan).maxCoeff()));
}

TEST(FootPoint, LiesInsideTheSegmentOrAtItsNearerEnd) {
    const Segment along_x{{0, 0}, {4, 0}};
    EXPECT_DOUBLE_EQ(foot_point({1, 2}, along_x).parameter, 0.25);
    EXPECT_DOUBLE_EQ(foot_point({1, 2}, along_x).distance_m, 2.0);
    EXPECT_DOUBLE_EQ(foot_point({-3, 4}, along_x).distance_m, 5.0);
    EXPECT_DOUBLE_EQ(foot_point({7, -4}, along_x).parameter, 1.0);
}

TEST(FootPoint, OfASegmentWithoutLengthIsItsOnlyPoint) {
    const FootPoint foot = foot_point({3, 4}, {{0, 0}, {0, 0}});
    EXPECT_DOUBLE_EQ(foot.parameter, 0.0);
    EXPECT_DOUBLE_EQ(foot.distance_m, 5.0);
}

TEST(SegmentDistance, ExactlyFacingSegmentsTieAndCountAsBetweenEnds) {
    const SegmentDistance facing = segment_distance({{0, 0}, {4, 0}}, {{0, 3}, {4, 3}});
    EXPECT_DOUBLE_EQ(facing.distance_m, 3.0);
    EXPECT_TRUE(facing.between_ends);
    // The segments are shifted along: an end faces the inside of the other, so it is not between two ends.
    EXPECT_FALSE(segment_distance({{0, 0}, {4, 0}}, {{1, 3}, {5, 3}}).between_ends);
}

TEST(SegmentDistance, CrossingTouchingAndOverlappingSegmentsHaveDistanceZero) {
    const SegmentDistance crossing = segment_distance({{0, 0}, {2, 2}}, {{0, 2}, {2, 0}});
    EXPECT_DOUBLE_EQ(crossing.distance_m, 0.0);
    EXPECT_FALSE(crossing.between_ends);
    const SegmentDistance end_on_inside = segment_distance({{0, 0}, {4, 0}}, {{2, 0}, {2, 3}});
    EXPECT_DOUBLE_EQ(end_on_inside.distance_m, 0.0);
    EXPECT_FALSE(end_on_inside.between_ends);
    const SegmentDistance end_on_end = segment_distance({{0, 0}, {4, 0}}, {{4, 0}, {5, 3}});
    EXPECT_DOUBLE_EQ(end_on_end.distance_m, 0.0);
    EXPECT_TRUE(end_on_end.between_ends);
    const SegmentDistance overlap = segment_distance({{0, 0}, {4, 0}}, {{1, 0}, {9, 0}});
    EXPECT_DOUBLE_EQ(overlap.distance_m, 0.0);
    EXPECT_FALSE(overlap.between_ends);
}

// For two segments without a common point, it is the smallest distance of an end from the other segment.
TEST(SegmentDistance, IsThatOfTheNearestEndsFootPoint) {
    boost::random::mt19937_64 random(1);
    boost::random::uniform_int_distribution<int> grid(-6, 6);  // touching, parallel and without length, too
    boost::random::uniform_real_distribution<double> anywhere(-6.0, 6.0);
    int apart = 0;
    int between_ends = 0;
    for (int k = 0; k < 20'000; ++k) {
        const auto point = [&] {
            return k % 2 == 0 ? Point(grid(random), grid(random)) : Point(anywhere(random), anywhere(random));
        };
        const Segment a{point(), point()};
        const Segment b{point(), point()};
        const SegmentDistance found = segment_distance(a, b);
        const SegmentDistance swapped = segment_distance({b.to, b.from}, a);
        EXPECT_NEAR(swapped.distance_m, found.distance_m, 1e-14);
        EXPECT_EQ(swapped.between_ends, found.between_ends);
        const double ends_m = std::min(
            {(a.from - b.from).norm(), (a.from - b.to).norm(), (a.to - b.from).norm(), (a.to - b.to).norm()});
        EXPECT_EQ(found.between_ends, ends_m <= found.distance_m + kTieTolerance);
        if (segments_intersect(a, b)) {
            EXPECT_EQ(found.distance_m, 0.0);
            continue;
        }
        EXPECT_NEAR(found.distance_m,
                    std::min({foot_point(a.from, b).distance_m, foot_point(a.to, b).distance_m,
                              foot_point(b.from, a).distance_m, foot_point(b.to, a).distance_m}),
                    1e-14);
        ++apart;
        between_ends += found.between_ends ? 1 : 0;
    }
    EXPECT_GT(apart, 5000);
    EXPECT_GT(between_ends, 1000);
}

TEST(Crossing, IsProperOnly) {
    EXPECT_TRUE(segments_cross({{0, 0}, {2, 2}}, {{0, 2}, {2, 0}}));
    EXPECT_FALSE(segments_cross({{0, 0}, {4, 0}}, {{2, 0}, {2, 3}}));
    EXPECT_FALSE(segments_cross({{0, 0}, {4, 0}}, {{2, -5e-10}, {2, 3}})) << "touching within a tie";
    EXPECT_TRUE(segments_cross({{0, 0}, {4, 0}}, {{2, -2e-9}, {2, 3}}));
    EXPECT_TRUE(segments_intersect({{0, 0}, {4, 0}}, {{2, 0}, {2, 3}}));
    EXPECT_TRUE(segments_intersect({{0, 0}, {4, 0}}, {{1, 0}, {9, 0}}));
    EXPECT_FALSE(segments_intersect({{0, 0}, {4, 0}}, {{5, 0}, {9, 0}}));
    EXPECT_FALSE(segments_intersect({{0, 0}, {4, 0}}, {{0, 1}, {4, 1}}));
}

TEST(Angle, InteriorIsPiStraightOnAndZeroWhereTheBoundaryFoldsBack) {
    EXPECT_DOUBLE_EQ(interior_angle({0, 0}, {1, 0}, {2, 0}), kPi);
    EXPECT_DOUBLE_EQ(interior_angle({0, 0}, {1, 0}, {1, 1}), kPi / 2);
    EXPECT_DOUBLE_EQ(interior_angle({0, 0}, {1, 0}, {1, -1}), kPi / 2);
    EXPECT_DOUBLE_EQ(interior_angle({0, 0}, {1, 0}, {0, 0}), 0.0);
}

TEST(Angle, TurningIsPositiveToTheLeftAndPiForAUTurn) {
    EXPECT_DOUBLE_EQ(turning_angle({1, 0}, {0, 1}), kPi / 2);
    EXPECT_DOUBLE_EQ(turning_angle({1, 0}, {0, -2}), -kPi / 2);
    EXPECT_DOUBLE_EQ(turning_angle({1, 0}, {-1, 0}), kPi);
    EXPECT_DOUBLE_EQ(turning_angle({1, 0}, {-1, -0.0}), kPi);
    EXPECT_DOUBLE_EQ(turning_angle({0, 0}, {-1, 0}), 0.0);
}

TEST(Polyline, LengthAndFoot) {
    const std::vector<Point> square{{0, 0}, {2, 0}, {2, 2}, {0, 2}};
    EXPECT_DOUBLE_EQ(polyline_length_m(square), 6.0);
    EXPECT_DOUBLE_EQ(polyline_length_m(square, true), 8.0);
    EXPECT_DOUBLE_EQ(foot_on_polyline({3, 1}, square).arc_length_m, 3.0);
    const PolylineFoot open = foot_on_polyline({-1, 0.5}, square);
    EXPECT_DOUBLE_EQ(open.arc_length_m, 0.0);
    const PolylineFoot closing = foot_on_polyline({-1, 0.5}, square, true);
    EXPECT_DOUBLE_EQ(closing.arc_length_m, 7.5);
    EXPECT_DOUBLE_EQ(closing.distance_m, 1.0);
    EXPECT_EQ(closing.segment, 3u);
    EXPECT_DOUBLE_EQ(foot_on_polyline({1, 1}, std::vector<Point>{{1, 4}}).distance_m, 3.0);
}

}  // namespace
}  // namespace conelane
