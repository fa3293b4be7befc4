// A movement of the whole map is distinguished from noise, drift and cones that moved alone.

#include "detectors/planner/rigid_shift.hpp"

#include "tests/support/testing.hpp"

#include <random>

namespace conelane {
namespace {

const std::vector<Point> kPlaces{{4, 1.7}, {8, 1.9}, {12, 1.6}, {4, -1.7}, {8, -1.8}, {12, -1.5}, {17, 3}};

std::vector<PlacePair> pairs_moved_by(const RigidShift& shift) {
    std::vector<PlacePair> pairs;
    for (const Point& place : kPlaces) pairs.push_back({place, shift(place)});
    return pairs;
}

TEST(RigidShift, TurnsAboutItsPlaceAndThenMoves) {
    const RigidShift shift{{1.0, 0.0}, std::acos(-1.0) / 2.0, {0.0, 5.0}};
    EXPECT_LT((shift({1.0, 0.0}) - Point(1.0, 5.0)).norm(), 1e-12);
    EXPECT_LT((shift({3.0, 0.0}) - Point(1.0, 7.0)).norm(), 1e-12);
    std::vector<DrivablePoint> points{{.position = {3.0, 0.0}, .heading_rad = 0.0}};
    move(points, shift);
    EXPECT_LT((points[0].position - Point(1.0, 7.0)).norm(), 1e-12);
    EXPECT_NEAR(points[0].heading_rad, std::acos(-1.0) / 2.0, 1e-12);
}

TEST(CommonShift, IsFoundAmongPairsWithATurnAndAnOutlier) {
    const RigidShift truth{{8.0, 0.0}, 0.03, {0.4, -0.3}};
    std::vector<PlacePair> pairs = pairs_moved_by(truth);
    pairs[3].seen += Point(0.9, 0.4);
    const auto found = common_shift(pairs, ShiftSettings{});
    ASSERT_TRUE(found);
    for (const Point& place : kPlaces) EXPECT_LT(((*found)(place)-truth(place)).norm(), 0.02);
}

TEST(CommonShift, NoiseAndFewConesAreNone) {
    std::mt19937 random(4);
    std::normal_distribution<double> noise(0.0, 0.08);
    std::vector<PlacePair> pairs = pairs_moved_by({});
    for (PlacePair& pair : pairs) {
        const double x_m = noise(random);
        pair.seen += Point(x_m, noise(random));
    }
    EXPECT_FALSE(common_shift(pairs, ShiftSettings{}));
    pairs = pairs_moved_by({{0.0, 0.0}, 0.0, {0.5, 0.0}});
    pairs.resize(4);
    EXPECT_FALSE(common_shift(pairs, ShiftSettings{}));
    EXPECT_FALSE(common_shift(std::vector<PlacePair>{}, ShiftSettings{}));
}

TEST(CommonShift, ConesThatMoveApartHaveNone) {
    std::vector<PlacePair> pairs = pairs_moved_by({});
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        pairs[i].seen += (i % 2 == 0 ? 1.0 : -1.0) * Point(0.5, 0.5);
    }
    EXPECT_FALSE(common_shift(pairs, ShiftSettings{}));
}

TEST(CommonShift, IsFoundWhereNothingSaysWhichConeIsWhich) {
    const Point by(0.45, 0.35);
    std::vector<Point> seen{{30.0, 4.0}};  // one that was not there before
    for (const Point& place : kPlaces) seen.push_back(place + by);
    const auto found = common_shift(kPlaces, seen, ShiftSettings{});
    ASSERT_TRUE(found);
    EXPECT_LT((found->by - by).norm(), 1e-9);
    EXPECT_FALSE(common_shift(kPlaces, kPlaces, ShiftSettings{}));
    const std::vector<Point> few(seen.begin(), seen.begin() + 4);
    EXPECT_FALSE(common_shift(kPlaces, few, ShiftSettings{}));
}

}  // namespace
}  // namespace conelane
