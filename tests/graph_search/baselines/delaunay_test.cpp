#include "graph_search/baselines/delaunay_beam/delaunay_triangulation.hpp"
#include "tests/support/testing.hpp"

#include <boost/polygon/voronoi.hpp>

namespace conelane {
namespace {

using Edges = std::set<std::pair<Vertex, Vertex>>;

/// The edges of all triangles.
Edges edges_of(const std::vector<Point>& points) {
    DelaunayTriangulation triangulation;
    SearchBudget unlimited;
    EXPECT_TRUE(triangulation.build(points, unlimited));
    Edges edges;
    for (DelaunayTriangulation::HalfEdge side = 0; side < triangulation.half_edge_count(); ++side)
        edges.insert(std::minmax(triangulation.origin(side), triangulation.target(side)));
    return edges;
}

/// The dual of the Voronoi diagram, by Boost. Precondition: distinct points with whole coordinates.
Edges voronoi_edges(const std::vector<Point>& points) {
    const auto sites = mapped(points, [](const Point& point) {
        return boost::polygon::point_data(static_cast<std::int32_t>(point.x()),
                                          static_cast<std::int32_t>(point.y()));
    });
    boost::polygon::voronoi_diagram<double> diagram;
    boost::polygon::construct_voronoi(sites.begin(), sites.end(), &diagram);
    Edges all;
    for (const auto& edge : diagram.edges()) {
        all.insert(std::minmax(static_cast<Vertex>(edge.cell()->source_index()),
                               static_cast<Vertex>(edge.twin()->cell()->source_index())));
    }
    return all;
}

/// Distinct points with whole coordinates in a square of this half side, including its corners. If the half
/// side is a power of two, each place is on the triangulation's grid.
std::vector<Point> whole_points(std::uint64_t seed, std::size_t count, int half_side) {
    boost::random::mt19937_64 random(seed);
    const boost::random::uniform_int_distribution<> coordinate(-half_side, half_side);
    std::set<std::pair<int, int>> places{{-half_side, -half_side}, {half_side, half_side}};
    while (places.size() < count) places.emplace(coordinate(random), coordinate(random));
    std::vector<Point> points;
    for (const auto& [x, y] : places) points.emplace_back(x, y);
    return points;
}

TEST(DelaunayTriangulation, ASquareHasNoDiagonalButTwoTriangles) {
    const std::vector<Point> square{{0, 0}, {2, 0}, {2, 2}, {0, 2}};
    DelaunayTriangulation triangulation;
    SearchBudget budget;
    ASSERT_TRUE(triangulation.build(square, budget));
    EXPECT_EQ(triangulation.half_edge_count(), 6u);
    EXPECT_THAT(edges_of(square), testing::IsSupersetOf(Edges{{0, 1}, {1, 2}, {2, 3}, {0, 3}}));
}

TEST(DelaunayTriangulation, PointsAtOnePlaceCountOnceAndFarOnesDoNoHarm) {
    EXPECT_EQ(edges_of({{0, 0}, {4, 0}, {0, 3}, {4, 0}, {0, 0}}), (Edges{{0, 1}, {1, 2}, {0, 2}}));
    const double huge = std::numeric_limits<double>::max();
    EXPECT_EQ(edges_of({{-huge, 0}, {huge, 0}, {0, huge}}), (Edges{{0, 1}, {1, 2}, {0, 2}}));
}

// Few places, so that many points are on one line or on one circle: inside such a circle, the triangulation
// has edges that the dual does not have.
TEST(DelaunayTriangulation, HasTheDualOfTheVoronoiDiagram) {
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        SCOPED_TRACE(seed);
        const std::vector<Point> points = whole_points(seed, 3 + seed % 40, seed % 3 == 0 ? 4 : 16);
        const Edges edges = edges_of(points);
        if (!edges.empty()) {  // not all points are on one line
            EXPECT_TRUE(std::ranges::includes(edges, voronoi_edges(points)));
        }
    }
    const std::vector<Point> many = whole_points(1, 2000, 1 << 20);
    EXPECT_TRUE(std::ranges::includes(edges_of(many), voronoi_edges(many)));
}

TEST(DelaunayTriangulation, TwinsAreOneEdgeAndTheHullIsConvex) {
    boost::random::mt19937_64 random(3);
    const boost::random::uniform_real_distribution<> coordinate(-30.0, 30.0);
    std::vector<Point> points;
    for (int i = 0; i < 200; ++i) {
        const double x_m = coordinate(random);
        points.emplace_back(x_m, coordinate(random));
    }
    DelaunayTriangulation triangulation;
    SearchBudget budget;
    ASSERT_TRUE(triangulation.build(points, budget));
    std::size_t hull = 0;
    for (DelaunayTriangulation::HalfEdge side = 0; side < triangulation.half_edge_count(); ++side) {
        const Point& from = points[triangulation.origin(side)];
        const Point& to = points[triangulation.target(side)];
        const Point& third = points[triangulation.target(DelaunayTriangulation::next(side))];
        EXPECT_GT(cross(to - from, third - from), 0.0) << "counter-clockwise";
        const DelaunayTriangulation::HalfEdge twin = triangulation.twin(side);
        if (twin == DelaunayTriangulation::kNone) {
            ++hull;
            for (const Point& point : points) EXPECT_GE(cross(to - from, point - from), -1e-6);
        } else {
            EXPECT_EQ(triangulation.twin(twin), side);
            EXPECT_EQ(triangulation.origin(twin), triangulation.target(side));
            EXPECT_EQ(triangulation.target(twin), triangulation.origin(side));
        }
    }
    EXPECT_EQ(triangulation.half_edge_count() / 3, 2 * points.size() - 2 - hull) << "Euler";
}

TEST(DelaunayTriangulation, EndsWithItsBudget) {
    std::vector<Point> points = whole_points(2, 3000, 1 << 10);
    DelaunayTriangulation triangulation;
    SearchBudget budget;
    budget.deadline = Deadline(0.0);
    EXPECT_FALSE(triangulation.build(points, budget));
    EXPECT_EQ(budget.stopped_by, StopReason::time);
    EXPECT_EQ(triangulation.half_edge_count(), 0u);
}

}  // namespace
}  // namespace conelane
