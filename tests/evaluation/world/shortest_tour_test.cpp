#include "evaluation/world/shortest_tour.hpp"

#include "tests/support/boundary_checks.hpp"

#include <numeric>

namespace conelane {
namespace {

std::vector<double> random_angles(std::uint64_t seed, double most_rad) {
    boost::random::mt19937_64 generator(seed);
    boost::random::uniform_real_distribution<double> any(0.0, most_rad);
    std::vector<double> angles(40);
    for (double& angle : angles) angle = any(generator);
    return angles;
}

std::vector<Point> on_ellipse(const std::vector<double>& angles, double across_m) {
    return mapped(
        angles, [&](const double angle) { return Point(30 * std::cos(angle), across_m * std::sin(angle)); });
}

TEST(ShortestTour, FindsTheOrderOfPointsOnAConvexCurve) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(seed);
        std::vector<double> angles = random_angles(seed, 6.28);
        const std::vector<Point> points = on_ellipse(angles, 12);
        std::ranges::sort(angles);
        const std::vector<Point> toured =
            mapped(shortest_tour(points), [&](const std::size_t index) { return points[index]; });
        EXPECT_NEAR(polyline_length_m(toured, true), polyline_length_m(on_ellipse(angles, 12), true), 1e-9);
    }
}

TEST(ShortestTour, VisitsEveryPointOnceAndDoesNotCrossItself) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(seed);
        boost::random::mt19937_64 generator(seed);
        boost::random::uniform_real_distribution<double> coordinate(-20.0, 20.0);
        std::vector<Point> points;
        for (std::uint64_t k = 0; k < 3 + 2 * seed; ++k) {
            const double x = coordinate(generator);
            points.emplace_back(x, coordinate(generator));
        }
        std::vector<std::size_t> tour = shortest_tour(points);
        const std::vector<Point> toured =
            mapped(tour, [&](const std::size_t index) { return points[index]; });
        EXPECT_TRUE(is_simple(toured, true));
        std::ranges::sort(tour);
        std::vector<std::size_t> everyone(points.size());
        std::iota(everyone.begin(), everyone.end(), std::size_t{0});
        EXPECT_EQ(tour, everyone);
    }
}

TEST(ShortestPath, FindsTheOrderOfPointsAlongABow) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(seed);
        const std::vector<double> angles = random_angles(seed, 4.5);
        const std::vector<Point> points = on_ellipse(angles, 30);
        std::vector<double> ordered =
            mapped(shortest_path(points), [&](const std::size_t index) { return angles[index]; });
        if (ordered.front() > ordered.back()) std::ranges::reverse(ordered);
        EXPECT_EQ(ordered.size(), angles.size());
        EXPECT_TRUE(std::ranges::is_sorted(ordered));
    }
}

}  // namespace
}  // namespace conelane
