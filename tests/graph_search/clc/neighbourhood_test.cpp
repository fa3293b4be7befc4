// Cones around a new segment of a lane: four vertices at a time, compared with one at a time.

#include "graph_search/clc/neighbourhood.hpp"

#include "tests/support/testing.hpp"

namespace conelane {
namespace {

Neighbourhood plain(const SearchGraph& graph, Vertex vertex, const Point& tip, const Point& facing,
                    const Point& point, const std::array<Point, 2>& left_out) {
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
        if (at == left_out[0] || at == left_out[1]) continue;
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
            // Rounding may put the segment's end on either side of it.
            for (const Point& left_out : {points[next], points[(tip + 3) % count]}) {
                const Neighbourhood found = neighbourhood(graph, tip, points[tip], points[facing],
                                                          points[next], left_out, points[next]);
                const Neighbourhood expected =
                    plain(graph, tip, points[tip], points[facing], points[next], {left_out, points[next]});
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

}  // namespace
}  // namespace conelane
