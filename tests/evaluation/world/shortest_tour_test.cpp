#include "evaluation/world/shortest_tour.hpp"

#include "tests/support/boundary_checks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <gtest/gtest.h>

namespace conelane {
namespace {

TEST(ShortestTour, FindsTheOrderOfPointsOnAConvexCurve) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(seed);
        boost::random::mt19937_64 generator(seed);
        std::vector<double> angles;
        for (int k = 0; k < 40; ++k) {
            angles.push_back(boost::random::uniform_real_distribution<double>(0.0, 6.28)(generator));
        }
        std::vector<Point> points;
        for (const double angle : angles) points.emplace_back(30 * std::cos(angle), 12 * std::sin(angle));
        std::vector<Point> convex;
        std::ranges::sort(angles);
        for (const double angle : angles) convex.emplace_back(30 * std::cos(angle), 12 * std::sin(angle));
        std::vector<Point> toured;
        for (const std::size_t index : shortest_tour(points)) toured.push_back(points[index]);
        EXPECT_NEAR(polyline_length_m(toured, true), polyline_length_m(convex, true), 1e-9);
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
        std::vector<Point> toured;
        for (const std::size_t index : tour) toured.push_back(points[index]);
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
        boost::random::mt19937_64 generator(seed);
        std::vector<double> angles;
        for (int k = 0; k < 40; ++k) {
            angles.push_back(boost::random::uniform_real_distribution<double>(0.0, 4.5)(generator));
        }
        std::vector<Point> points;
        for (const double angle : angles) points.emplace_back(30 * std::cos(angle), 30 * std::sin(angle));
        std::vector<double> ordered;
        for (const std::size_t index : shortest_path(points)) ordered.push_back(angles[index]);
        if (ordered.front() > ordered.back()) std::ranges::reverse(ordered);
        EXPECT_EQ(ordered.size(), angles.size());
        EXPECT_TRUE(std::ranges::is_sorted(ordered));
    }
}

}  // namespace
}  // namespace conelane
