// Where a lane may start and go on: the search graph, the deciders, start pairs, cones around a step.

#include "graph_search/clc/start_vertices.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/metamorphic.hpp"

namespace conelane {
namespace {

using tests::cones_at;

std::vector<Vertex> vertices_of(const NextVertexDecider& decider, NextVertexDecider::Range range) {
    std::vector<Vertex> vertices;
    for (auto i = range.begin; i != range.end; ++i) vertices.push_back(decider.option(i).vertex);
    return vertices;
}

bool adjacent(const SearchGraph& graph, Vertex a, Vertex b) {
    return std::ranges::binary_search(graph.neighbours(a), b);
}

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
    const auto order = [&](NextVertexDecider::Range range) { return vertices_of(decider, range); };
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

TEST(StepReach, EndsAtTheLastOfTheNearestNeighbours) {
    SearchGraph graph;
    graph.build(std::vector<Point>{{0, 0}, {4, 0}, {1, 0}, {0, 3}, {-2, 0}, {0, 9}}, 5.0);
    StepReach reach;
    reach.reset(graph, 2);
    EXPECT_DOUBLE_EQ(reach.squared_m2(0), 4.0);
    EXPECT_DOUBLE_EQ(reach.squared_m2(0), 4.0) << "asked for again";
    EXPECT_THAT(reach.steps(0), ElementsAre(1, 3)) << "vertices 2 and 4 of 1 to 4";
    reach.reset(graph, 3);
    EXPECT_THAT(reach.steps(0), ElementsAre(1, 2, 3)) << "without a question before";
    EXPECT_DOUBLE_EQ(reach.squared_m2(0), 9.0);
    reach.reset(graph, 4);
    EXPECT_EQ(reach.squared_m2(0), std::numeric_limits<double>::infinity()) << "no more than four neighbours";
    EXPECT_THAT(reach.steps(0), ElementsAre(0, 1, 2, 3));
    EXPECT_EQ(reach.squared_m2(5), std::numeric_limits<double>::infinity()) << "no neighbour";
    EXPECT_THAT(reach.steps(5), IsEmpty());
    reach.reset(graph, 0);
    EXPECT_EQ(reach.squared_m2(0), std::numeric_limits<double>::infinity()) << "0: all";
}

TEST(StepReach, LeavesFartherNeighboursOutOfTheNextVertices) {
    SearchGraph graph;
    // Of the two at 2 m, which are as near as each other, none is left out.
    graph.build(std::vector<Point>{{0, 0}, {4, 0}, {1, 0}, {0, 2}, {0, -2}}, 5.0);
    StepReach reach;
    reach.reset(graph, 2);
    NextVertexDecider next;
    next.reset(graph, 0.0, &reach);
    const NextVertexDecider::Range range = next.after_start(0, {1.0, 0.0});
    EXPECT_THAT(vertices_of(next, range), ElementsAre(2, 3, 4));
    for (std::uint32_t i = range.begin; i != range.end; ++i) {
        const NextVertex& option = next.option(i);
        EXPECT_EQ(graph.neighbours(0)[option.edge - graph.first_edge(0)], option.vertex);
    }
}

/// One vertex at a time.
Neighbourhood plain(const SearchGraph& graph, Vertex vertex, const NewSegment& added) {
    const auto& [tip, point, facing, leaves_ends_out] = added;
    Neighbourhood found;
    const Point segment = point - tip;
    for (const Vertex neighbour : graph.neighbours(vertex)) {
        const Point& at = graph.position(neighbour);
        const double a = cross(facing - tip, at - tip);
        const double b = cross(point - facing, at - facing);
        const double c = cross(tip - point, at - point);
        if ((a > 0.0 && b > 0.0 && c > 0.0) || (a < 0.0 && b < 0.0 && c < 0.0)) found.inside += 1.0;
        const double along_m = (at - tip).dot(segment) / segment.norm();
        const double across_m = std::abs(cross(segment, at - tip)) / segment.norm();
        if (along_m <= 0.0 || along_m >= segment.norm() || across_m >= kBeside_m) continue;
        if (leaves_ends_out && (at == point || at == facing)) continue;
        found.beside += 1.0;
        if (across_m < kClose_m) found.close += 1.0;
        found.closeness += std::pow(1.0 - std::pow(across_m / kBeside_m, 2), 2);
    }
    return found;
}

TEST(Neighbourhood, AreCountedForAnyNumberOfVertices) {
    boost::random::mt19937_64 random(3);
    boost::random::uniform_real_distribution<double> draw(-4.0, 4.0);
    double inside = 0.0;
    double close = 0.0;
    for (std::size_t count = 3; count < 40; ++count) {
        std::vector<Point> points(count);
        for (Point& point : points) point = {draw(random), draw(random)};
        SearchGraph graph;
        graph.build(points, 6.0);
        for (Vertex tip = 0; tip < count; ++tip) {
            const Vertex facing = (tip + 1) % static_cast<Vertex>(count);
            const Vertex next = (tip + 2) % static_cast<Vertex>(count);
            // Rounding may put the end of the segment on either side of it, so the neighbours of the end
            // itself are counted where it is not left out.
            for (const bool leaves_ends_out : {true, false}) {
                const NewSegment added{.tip = points[tip],
                                       .point = points[next],
                                       .facing = points[facing],
                                       .leaves_ends_out = leaves_ends_out};
                const Vertex around = leaves_ends_out ? tip : next;
                const Neighbourhood found = neighbourhood(graph, around, added);
                const Neighbourhood expected = plain(graph, around, added);
                EXPECT_EQ(found.inside, expected.inside);
                EXPECT_EQ(found.beside, expected.beside);
                EXPECT_EQ(found.close, expected.close);
                EXPECT_NEAR(found.closeness, expected.closeness, 1e-9);
                inside += found.inside;
                close += found.close;
            }
        }
    }
    EXPECT_GT(inside, 100.0);
    EXPECT_GT(close, 100.0);
}

TEST(StartPairs, LeftIsLeftOfTheHeadingAndRightIsRight) {
    Scene scene = cones_at({{0.5, -1.6}, {0.5, 1.6}});
    EXPECT_THAT(start_pairs(scene, 1, {}), ElementsAre(StartPair{1, 0}));
    // With the heading reversed, left and right are exchanged.
    scene.pose.yaw_rad = 3.14159;
    EXPECT_THAT(start_pairs(scene, 1, {}), ElementsAre(StartPair{0, 1}));
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
    const std::vector<Point> too_narrow{{1, 1.2}, {1, -1.2}};
    const std::vector<Point> too_wide{{1, 3.3}, {1, -3.3}};
    const std::vector<Point> one_side_only{{1, 1.2}, {5, 1.2}, {3, 0}};
    for (const std::vector<Point>& cones : {too_narrow, too_wide, one_side_only, {}})
        EXPECT_THAT(start_pairs(cones_at(cones), 3, {}), IsEmpty());
}

TEST(StartPairs, KeepToTheWidthsOfTheLanesBounds) {
    const Scene narrow = cones_at({{1, 1.2}, {1, -1.2}});
    LaneBounds bounds{.w_min_m = 2.0};
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
    const Scene scene = cones_at({{1, 1.5}, {1, -1.5}, {2, 2}, {2, -2}, {3, -1.4}, {0.5, 2.2}});
    std::vector<StartPair> of_mirrored = start_pairs(tests::mirrored(scene), 5, {});
    ASSERT_EQ(of_mirrored.size(), 5u);
    for (StartPair& pair : of_mirrored) std::swap(pair.left, pair.right);
    EXPECT_EQ(start_pairs(scene, 5, {}), of_mirrored);
}

}  // namespace
}  // namespace conelane
