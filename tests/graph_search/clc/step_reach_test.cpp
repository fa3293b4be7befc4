#include "graph_search/clc/step_reach.hpp"

#include "graph_search/clc/next_vertex.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(StepReach, EndsAtTheLastOfTheNearestNeighbours) {
    SearchGraph graph;
    graph.build(std::vector<Point>{{0, 0}, {4, 0}, {1, 0}, {0, 3}, {-2, 0}, {0, 9}}, 5.0);
    StepReach reach;
    reach.reset(graph, 2);
    EXPECT_DOUBLE_EQ(reach.squared_m2(0), 4.0);
    EXPECT_DOUBLE_EQ(reach.squared_m2(0), 4.0) << "asked for again";
    EXPECT_THAT(reach.steps(0), testing::ElementsAre(1, 3)) << "vertices 2 and 4 of 1 to 4";
    reach.reset(graph, 3);
    EXPECT_THAT(reach.steps(0), testing::ElementsAre(1, 2, 3)) << "without a question before";
    EXPECT_DOUBLE_EQ(reach.squared_m2(0), 9.0);
    reach.reset(graph, 4);
    EXPECT_EQ(reach.squared_m2(0), kInfinity) << "no more than four neighbours";
    EXPECT_THAT(reach.steps(0), testing::ElementsAre(0, 1, 2, 3));
    EXPECT_EQ(reach.squared_m2(5), kInfinity) << "no neighbour";
    EXPECT_THAT(reach.steps(5), testing::IsEmpty());
    reach.reset(graph, 0);
    EXPECT_EQ(reach.squared_m2(0), kInfinity) << "0: all";
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
    std::vector<Vertex> vertices;
    for (std::uint32_t i = range.begin; i != range.end; ++i) {
        vertices.push_back(next.option(i).vertex);
        EXPECT_EQ(graph.neighbours(0)[next.option(i).edge - graph.first_edge(0)], vertices.back());
    }
    EXPECT_THAT(vertices, testing::ElementsAre(2, 3, 4));
}

}  // namespace
}  // namespace conelane
