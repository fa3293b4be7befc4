#include "graph_search/shared/search_graph.hpp"

#include "graph_search/clc/left_right.hpp"
#include "graph_search/clc/next_vertex.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

bool adjacent(const SearchGraph& graph, Vertex a, Vertex b) {
    return std::ranges::binary_search(graph.neighbours(a), b);
}

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(SearchGraph, JoinsWhatIsAtMostDMaxApart) {
    SearchGraph graph;
    graph.build(std::vector<Point>{{0, 0}, {5.5, 0}, {5.5, 5.6}, {0, -3}}, 5.5);
    EXPECT_THAT(graph.neighbours(0), ElementsAre(1, 3));
    EXPECT_THAT(graph.neighbours(1), ElementsAre(0));
    EXPECT_THAT(graph.neighbours(2), IsEmpty());
    EXPECT_TRUE(adjacent(graph, 3, 0));
    EXPECT_FALSE(adjacent(graph, 2, 1));
}

TEST(SearchGraph, DoesNotJoinPointsAtTheSamePlace) {
    SearchGraph graph;
    graph.build(std::vector<Point>{{1, 1}, {1, 1}, {2, 1}}, 5.5);
    EXPECT_THAT(graph.neighbours(0), ElementsAre(2));
    EXPECT_THAT(graph.neighbours(2), ElementsAre(0, 1));
}

TEST(SearchGraph, HoldsForNoPointsAndForPointsFarAway) {
    SearchGraph graph;
    graph.build({}, 5.5);
    EXPECT_EQ(graph.vertex_count(), 0u);
    graph.build(std::vector<Point>{{-1e308, 0}, {1e308, 0}, {1e308, 3}, {0, 0}, {1e20, 1}, {1e20, 2}}, 5.5);
    EXPECT_THAT(graph.neighbours(1), ElementsAre(2));
    EXPECT_THAT(graph.neighbours(3), IsEmpty());
    EXPECT_THAT(graph.neighbours(4), ElementsAre(5));
}

TEST(SearchGraph, EqualsTheDefinitionOnRandomMaps) {
    SearchGraph graph;  // one object for all maps: nothing is left of an earlier map
    for (unsigned seed = 0; seed < 50; ++seed) {
        SCOPED_TRACE(seed);
        boost::random::mt19937_64 random(seed);
        boost::random::uniform_real_distribution<> coordinate(-20.0, 20.0);
        std::vector<Point> points;
        for (unsigned i = 0; i < seed * 3; ++i) {
            const double x = coordinate(random);
            points.emplace_back(x, coordinate(random));
        }
        graph.build(points, 5.5);
        ASSERT_EQ(graph.vertex_count(), points.size());
        for (Vertex i = 0; i < points.size(); ++i) {
            std::vector<Vertex> expected;
            for (Vertex j = 0; j < points.size(); ++j) {
                if (i != j && (points[i] - points[j]).norm() <= 5.5) expected.push_back(j);
            }
            ASSERT_THAT(graph.neighbours(i), ::testing::ElementsAreArray(expected)) << "vertex " << i;
        }
    }
}

TEST(TurningMeasure, GrowsWithTheAngleToEitherSide) {
    EXPECT_EQ(turning_measure({1, 0}, {3, 0}), 0.0);
    EXPECT_EQ(turning_measure({1, 0}, {0, 2}), 1.0);
    EXPECT_EQ(turning_measure({1, 0}, {0, -2}), 1.0);
    EXPECT_EQ(turning_measure({1, 0}, {-2, 0}), 2.0);
    EXPECT_EQ(turning_measure(std::numbers::pi / 2), 1.0);
    double before = -1.0;
    for (int degree = 0; degree <= 180; ++degree) {
        const double angle_rad = degree * std::numbers::pi / 180.0;
        const double measure = turning_measure({1, 0}, {2 * std::cos(angle_rad), -2 * std::sin(angle_rad)});
        EXPECT_GT(measure, before) << degree;
        EXPECT_NEAR(measure, turning_measure(angle_rad), 1e-15) << degree;
        before = measure;
    }
}

TEST(TurningMeasure, GivesTheAngleNearly) {
    for (int i = 0; i <= 18000; ++i) {
        const double angle_rad = i * std::numbers::pi / 18000.0;
        ASSERT_NEAR(nearly_angle_rad(turning_measure(angle_rad)), angle_rad, kNearlyAngle_rad) << i;
    }
}

// As in Figure 4: of four neighbours, the one that continues the last segment comes first.
TEST(NextVertexDecider, OrdersNeighboursByTheAngleOfTheTurn) {
    SearchGraph graph;
    const std::vector<Point> points{{0, 0}, {4, 0}, {6, 3}, {8, 0.5}, {7, -2}, {4, 4}};
    graph.build(points, 5.5);
    NextVertexDecider decider;
    decider.reset(graph);
    const auto order = [&](NextVertexDecider::Range range) {
        std::vector<Vertex> vertices;
        for (auto i = range.begin; i != range.end; ++i) vertices.push_back(decider.option(i).vertex);
        return vertices;
    };
    const SearchGraph::DirectedEdge from_0_to_1 = graph.first_edge(0);
    ASSERT_THAT(graph.neighbours(0), ElementsAre(1));
    EXPECT_THAT(order(decider.after(0, 1, from_0_to_1)), ElementsAre(3, 4, 2, 5, 0));
    EXPECT_EQ(decider.after(0, 1, from_0_to_1).begin, decider.after(0, 1, from_0_to_1).begin);
    // Without a segment the car's heading counts.
    EXPECT_THAT(order(decider.after_start(1, {0, 1})), ElementsAre(5, 2, 3, 0, 4));
}

TEST(LeftRightDecider, AdvancesTheBoundaryThatIsBehind) {
    // Equally advanced boundaries have no deviation, however wide the lane is.
    EXPECT_NEAR(advance_deviation({4, 2}, {4, 0}, {4, -2}, {4, 0}), 0.0, 1e-15);
    EXPECT_GT(advance_deviation({8, 2}, {4, 0}, {4, -2}, {4, 0}), 0.1);
    const BoundaryTip left{{4, 2}, {4, 0}, {8, 2}};
    const BoundaryTip right{{0, -2}, {4, 0}, {4, -2}};
    EXPECT_EQ(left_right_decision({left, right}, kLeft), kRight);
    const BoundaryTip right_ahead{{8, -2}, {4, 0}, {12, -2}};
    EXPECT_EQ(left_right_decision({left, right_ahead}, kRight), kLeft);
    const BoundaryTip right_level{{4, -2}, {4, 0}, {8, -2}};
    EXPECT_EQ(left_right_decision({left, right_level}, kLeft), kLeft);
    EXPECT_EQ(left_right_decision({left, right_level}, kRight), kRight);
}

TEST(SearchGraph, WithARuleJoinsThePairsOfTheRuleThatAreNear) {
    const std::vector<Point> points{{0, 0}, {4, 0}, {8, 0}, {4, 3}};
    const EdgeRule rule = [](std::span<const Point> all) {
        EXPECT_EQ(all.size(), 4u);
        return std::vector<std::pair<Vertex, Vertex>>{{1, 0}, {0, 2}, {1, 3}, {3, 1}};
    };
    SearchGraph graph;
    graph.build(points, 5.5, rule);
    EXPECT_THAT(graph.neighbours(0), ElementsAre(1));
    EXPECT_THAT(graph.neighbours(1), ElementsAre(0, 3));
    EXPECT_THAT(graph.neighbours(2), IsEmpty()) << "0 is 8 m off";
    EXPECT_THAT(graph.neighbours(3), ElementsAre(1));
    graph.build(points, 5.5);
    EXPECT_THAT(graph.neighbours(2), ElementsAre(1, 3));
}

}  // namespace
}  // namespace conelane
