#include "experiments/delaunay.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace conelane::experiments {
namespace {

TEST(DelaunayGraph, JoinsWhatTheTriangulationJoins) {
    // A rhombus: the short diagonal is in it, the long one is not.
    const std::vector<Point> points{{0, 0}, {2, 1}, {4, 0}, {2, -1}};
    SearchGraph graph;
    graph.build(points, 5.0, delaunay_edges);
    EXPECT_TRUE(graph.adjacent(1, 3));
    EXPECT_FALSE(graph.adjacent(0, 2));
    EXPECT_EQ(graph.directed_edge_count(), 10u);
    graph.build(points, 2.2, delaunay_edges);
    EXPECT_EQ(graph.directed_edge_count(), 2u) << "nothing beyond d_max: the sides are 2.24 m long";
    graph.build(points, 5.0);
    EXPECT_TRUE(graph.adjacent(0, 2));
}

TEST(DelaunayGraph, OfPointsOnALineOrAtOnePlaceOrNone) {
    SearchGraph graph;
    graph.build(std::vector<Point>{{0, 0}, {1, 0}, {2, 0}, {3, 0}}, 5.0, delaunay_edges);
    EXPECT_EQ(graph.directed_edge_count(), 6u);
    graph.build(std::vector<Point>{{1, 1}, {1, 1}, {1, 1}}, 5.0, delaunay_edges);
    EXPECT_EQ(graph.directed_edge_count(), 0u);
    graph.build(std::vector<Point>{}, 5.0, delaunay_edges);
    EXPECT_EQ(graph.vertex_count(), 0u);
}

}  // namespace
}  // namespace conelane::experiments
