#include "graph_search/clc/start_vertices.hpp"

#include "tests/support/cones_at.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using tests::cones_at;

Scene turned(Scene scene, double yaw_rad) {
    scene.pose.yaw_rad = yaw_rad;
    return scene;
}

TEST(StartPairs, LeftIsLeftOfTheHeadingAndRightIsRight) {
    const Scene scene = cones_at({{0.5, -1.6}, {0.5, 1.6}});
    EXPECT_THAT(start_pairs(scene, 1, {}), ElementsAre(StartPair{1, 0}));
    // With the heading reversed, left and right are exchanged.
    EXPECT_THAT(start_pairs(turned(cones_at({{0.5, -1.6}, {0.5, 1.6}}), 3.14159), 1, {}),
                ElementsAre(StartPair{0, 1}));
}

TEST(StartPairs, TakesTheMostSymmetricPairNearTheCar) {
    // Vertex 2 stands more exactly opposite of 0 than 1 does.
    const Scene scene = cones_at({{0.5, 1.6}, {1.0, -1.4}, {0.5, -1.6}, {5.0, 1.8}, {5.0, -1.8}});
    EXPECT_EQ(start_pairs(scene, 1, {}).front(), (StartPair{0, 2}));
    const std::vector<StartPair> three = start_pairs(scene, 3, {});
    EXPECT_THAT(three, ElementsAre(StartPair{0, 2}, StartPair{0, 1}, StartPair{3, 4}));
}

TEST(StartPairs, LooksFartherWhereNothingIsNear) {
    EXPECT_THAT(start_pairs(cones_at({{5.5, 1.7}, {4.0, -1.7}}), 1, {}), ElementsAre(StartPair{0, 1}));
    EXPECT_THAT(start_pairs(cones_at({{15.5, 1.7}, {14.0, -1.7}}), 1, {}), IsEmpty());
}

TEST(StartPairs, LeavesOutPairsThatNoLaneCanStartWith) {
    const Scene too_narrow = cones_at({{1, 1.2}, {1, -1.2}});
    EXPECT_THAT(start_pairs(too_narrow, 3, {}), IsEmpty());
    const Scene too_wide = cones_at({{1, 3.3}, {1, -3.3}});
    EXPECT_THAT(start_pairs(too_wide, 3, {}), IsEmpty());
    const Scene one_side_only = cones_at({{1, 1.2}, {5, 1.2}, {3, 0}});
    EXPECT_THAT(start_pairs(one_side_only, 3, {}), IsEmpty());
    EXPECT_THAT(start_pairs(cones_at({}), 3, {}), IsEmpty());
}

TEST(StartPairs, KeepToTheWidthsOfTheLanesBounds) {
    const Scene narrow = cones_at({{1, 1.2}, {1, -1.2}});
    LaneBounds bounds;
    bounds.w_min_m = 2.0;
    EXPECT_THAT(start_pairs(narrow, 3, {}, bounds), ElementsAre(StartPair{0, 1}));
    bounds.w_max_m = 2.4;
    EXPECT_THAT(start_pairs(narrow, 3, {}, bounds), IsEmpty());
}

TEST(StartPairs, OfACrowdAreThoseOfTheNearestVertices) {
    std::vector<Point> points;
    for (int i = 0; i < 400; ++i) {
        points.emplace_back(7.0 - 0.01 * i, 2.0);
        points.emplace_back(7.0 - 0.01 * i, -2.0);
    }
    StartPairs pairs;
    pairs.find(cones_at(points), {}, {});
    EXPECT_FALSE(pairs.complete());
    EXPECT_EQ(pairs.ranked().size(), StartPairs::kMaxVertices * StartPairs::kMaxVertices);
    EXPECT_EQ(pairs.ranked().front().pair, (StartPair{798, 799})) << "the nearest two";
    points.resize(2 * StartPairs::kMaxVertices);
    pairs.find(cones_at(points), {}, {});
    EXPECT_TRUE(pairs.complete());
}

TEST(StartPairMeasures, ByHand) {
    for (const double sign : {1.0, -1.0}) {  // the scene and its mirror image
        const Scene scene = cones_at({{3.0, sign * 1.5}, {-1.0, sign * -4.5}});
        const StartPairMeasures measures =
            start_pair_measures(scene, sign > 0.0 ? StartPair{0, 1} : StartPair{1, 0});
        EXPECT_DOUBLE_EQ(measures.asymmetry_m, 5.0);
        EXPECT_DOUBLE_EQ(measures.distance_m, std::hypot(1.0, 4.5));
        EXPECT_DOUBLE_EQ(measures.lead_m, 4.0);
        EXPECT_DOUBLE_EQ(measures.shift_m, 3.0);
        EXPECT_DOUBLE_EQ(measures.nearest_side_m, 1.5);
        EXPECT_DOUBLE_EQ(measures.nearest_ahead_m, -1.0);
        EXPECT_DOUBLE_EQ(measures.farthest_ahead_m, 3.0);
    }
}

TEST(StartPairs, OfAMirroredSceneAreMirrored) {
    const std::vector<Point> points{{1, 1.5}, {1, -1.5}, {2, 2}, {2, -2}, {3, -1.4}, {0.5, 2.2}};
    std::vector<Point> mirrored;
    for (const Point& point : points) mirrored.emplace_back(point.x(), -point.y());
    const std::vector<StartPair> pairs = start_pairs(cones_at(points), 5, {});
    const std::vector<StartPair> of_mirrored = start_pairs(cones_at(mirrored), 5, {});
    ASSERT_EQ(pairs.size(), 5u);
    ASSERT_EQ(of_mirrored.size(), 5u);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        EXPECT_EQ(pairs[i], (StartPair{of_mirrored[i].right, of_mirrored[i].left})) << i;
    }
}

}  // namespace
}  // namespace conelane
