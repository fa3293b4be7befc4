#include "evaluation/scoring/lane_iou.hpp"

#include "model/geometry.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

/// A straight lane along +x, 4 m wide, the left boundary at y = 2.
LaneOutline straight(double length_m, double shift_left_m = 0.0) {
    return {{{0, 2 + shift_left_m}, {length_m, 2 + shift_left_m}},
            {{0, -2 + shift_left_m}, {length_m, -2 + shift_left_m}}};
}

LaneOutline with_swapped_sides(LaneOutline lane) {
    std::swap(lane.left, lane.right);
    return lane;
}

/// A square circuit with corners (0, 0) and (10, 10), driven clockwise, and its inner boundary 2 m inside.
const std::vector<Point> kOuterClockwise{{0, 0}, {0, 10}, {10, 10}, {10, 0}};
const std::vector<Point> kInnerClockwise{{2, 2}, {2, 8}, {8, 8}, {8, 2}};
std::vector<Point> reversed(std::vector<Point> vertices) {
    std::ranges::reverse(vertices);
    return vertices;
}

TEST(LaneArea, IsThatBetweenTheBoundaries) {
    EXPECT_DOUBLE_EQ(lane_area_m2(straight(10)), 40.0);
    EXPECT_DOUBLE_EQ(lane_length_m(straight(10)), 10.0);
    EXPECT_DOUBLE_EQ(lane_length_m({{{0, 0}, {4, 0}}, {{0, -3}, {8, -3}}}), 6.0);
}

TEST(LaneArea, IsZeroWithSwappedSides) {
    EXPECT_DOUBLE_EQ(lane_area_m2(with_swapped_sides(straight(10))), 0.0);
}

TEST(LaneArea, OfAFigureEightIsItsClockwisePart) {
    // The boundaries cross at (5, 0): the triangle before it is clockwise, the one after it is not.
    const LaneOutline eight{{{0, 2}, {10, -2}}, {{0, -2}, {10, 2}}};
    EXPECT_DOUBLE_EQ(lane_area_m2(eight), 10.0);
    EXPECT_DOUBLE_EQ(intersection_over_union(eight, straight(10)), 0.25);
    EXPECT_DOUBLE_EQ(lane_area_m2(with_swapped_sides(eight)), 10.0);
    EXPECT_DOUBLE_EQ(intersection_over_union(eight, with_swapped_sides(eight)), 0.0);
}

TEST(LaneArea, OfALaneThatCrossesTwiceLacksTheMiddle) {
    // Sides are swapped between x = 5 and x = 15.
    const LaneOutline lane{{{0, 2}, {10, -2}, {20, 2}}, {{0, -2}, {10, 2}, {20, -2}}};
    EXPECT_DOUBLE_EQ(lane_area_m2(lane), 20.0);
}

TEST(LaneArea, OfALaneOverItselfCountsOnceAndLeavesTheInfieldOut) {
    LaneOutline lane{kOuterClockwise, kInnerClockwise};
    lane.left.insert(lane.left.end(), {{0, 0}, {0, 5}});
    lane.right.insert(lane.right.end(), {{2, 2}, {2, 5}});
    EXPECT_DOUBLE_EQ(lane_area_m2(lane), 64.0);
}

TEST(LaneArea, OfAClosedLaneIsTheRingInEitherDrivingDirection) {
    const LaneOutline clockwise{kOuterClockwise, kInnerClockwise, true};
    const LaneOutline counter_clockwise{reversed(kInnerClockwise), reversed(kOuterClockwise), true};
    EXPECT_DOUBLE_EQ(lane_area_m2(clockwise), 64.0);
    EXPECT_DOUBLE_EQ(lane_area_m2(counter_clockwise), 64.0);
    EXPECT_DOUBLE_EQ(intersection_over_union(clockwise, counter_clockwise), 1.0);
    EXPECT_DOUBLE_EQ(lane_area_m2(with_swapped_sides(clockwise)), 0.0);
    EXPECT_DOUBLE_EQ(lane_area_m2(with_swapped_sides(counter_clockwise)), 0.0);
    EXPECT_DOUBLE_EQ(lane_length_m(clockwise), 32.0);
}

TEST(LaneArea, OfAnOpenLaneRoundTheCircuitLacksTheLastStretch) {
    const LaneOutline open{kOuterClockwise, kInnerClockwise, false};
    EXPECT_DOUBLE_EQ(lane_area_m2(open), 48.0);
    EXPECT_DOUBLE_EQ(intersection_over_union(open, {kOuterClockwise, kInnerClockwise, true}), 0.75);
}

TEST(IntersectionOverUnion, OfLanesThatOverlapInPart) {
    EXPECT_DOUBLE_EQ(intersection_over_union(straight(10), straight(5)), 0.5);
    EXPECT_DOUBLE_EQ(intersection_over_union(straight(10), straight(10, 2)), 1.0 / 3.0);
    EXPECT_DOUBLE_EQ(intersection_over_union(straight(10), straight(10, 4)), 0.0);
    EXPECT_DOUBLE_EQ(intersection_over_union(straight(10), straight(10, 50)), 0.0);
}

TEST(IntersectionOverUnion, HoldsFarFromTheOriginAndOnKilometres) {
    LaneOutline far = straight(10);
    LaneOutline half = straight(5);
    for (LaneOutline* lane : {&far, &half}) {
        for (std::vector<Point>* side : {&lane->left, &lane->right}) {
            for (Point& vertex : *side) vertex += Point(4'500'000.0, -700'000.0);
        }
    }
    EXPECT_NEAR(intersection_over_union(far, half), 0.5, 1e-9);
    EXPECT_NEAR(intersection_over_union(straight(100'000), straight(50'000)), 0.5, 1e-3);
}

TEST(IntersectionOverUnion, OfDegenerateLanesIsZero) {
    const std::vector<Point> spike{{0, 2}, {10, 2}, {5, 2}};
    const std::vector<LaneOutline> without_area{
        {},
        {{{0, 2}}, {{0, -2}}},
        {{{0, 2}, {10, 2}}, {{0, -2}}},
        {{}, {{0, -2}, {10, -2}}},
        {{{1, 1}, {1, 1}}, {{1, 1}, {1, 1}}},
        {{{0, 2}, {10, 2}}, {{0, 2}, {10, 2}}},
        {{{0, 0}, {5, 0}}, {{7, 0}, {9, 0}}},
        {spike, spike},
        {{{0, 2}, {10, 2}}, {{0, -2}, {10, -2}}, true},
    };
    for (std::size_t i = 0; i < without_area.size(); ++i) {
        EXPECT_EQ(lane_area_m2(without_area[i]), 0.0) << i;
        EXPECT_EQ(intersection_over_union(without_area[i], straight(10)), 0.0) << i;
        EXPECT_EQ(intersection_over_union(straight(10), without_area[i]), 0.0) << i;
        EXPECT_EQ(intersection_over_union(without_area[i], without_area[i]), 0.0) << i;
    }
}

TEST(IntersectionOverUnion, IgnoresRepeatedVerticesAndSpikes) {
    const LaneOutline ragged{{{0, 2}, {0, 2}, {6, 2}, {6, 9}, {6, 2}, {10, 2}},
                             {{0, -2}, {7, -2}, {3, -2}, {10, -2}, {10, -2}}};
    EXPECT_DOUBLE_EQ(lane_area_m2(ragged), 40.0);
    EXPECT_DOUBLE_EQ(intersection_over_union(ragged, straight(10)), 1.0);
}

using Random = boost::random::mt19937_64;

/// A lane of gentle curves, whose sides do not cross.
LaneOutline random_lane(Random& random) {
    boost::random::uniform_real_distribution<double> turn_rad(-0.25, 0.25);
    boost::random::uniform_real_distribution<double> half_width_m(1.5, 2.2);
    boost::random::uniform_int_distribution<int> count(3, 14);
    LaneOutline lane;
    Point position(0, 0);
    double yaw_rad = 0.0;
    const int vertices = count(random);
    for (int i = 0; i < vertices; ++i) {
        const Point heading(std::cos(yaw_rad), std::sin(yaw_rad));
        const Point leftward(-heading.y(), heading.x());
        lane.left.emplace_back(position + half_width_m(random) * leftward);
        lane.right.emplace_back(position - half_width_m(random) * leftward);
        yaw_rad += turn_rad(random);
        position += 4.0 * heading;
    }
    return lane;
}

template <typename Map>
LaneOutline mapped(LaneOutline lane, Map map) {
    for (std::vector<Point>* side : {&lane.left, &lane.right})
        std::ranges::transform(*side, side->begin(), map);
    return lane;
}

TEST(IntersectionOverUnionProperty, SymmetricBoundedAndTheSameWhereverTheLanesLie) {
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Random random(seed);
        const LaneOutline a = random_lane(random);
        const LaneOutline b = random_lane(random);
        const double iou = intersection_over_union(a, b);
        EXPECT_GT(iou, 0.0);  // both start at the same place
        EXPECT_LT(iou, 1.0);
        EXPECT_EQ(iou, intersection_over_union(b, a));
        EXPECT_EQ(intersection_over_union(a, a), 1.0);

        boost::random::uniform_real_distribution<double> angle_rad(-std::numbers::pi, std::numbers::pi);
        boost::random::uniform_real_distribution<double> shift_m(-200.0, 200.0);
        const double yaw_rad = angle_rad(random);
        const Point shift(shift_m(random), shift_m(random));
        const auto move = [&](const Point& p) {
            return Point(std::cos(yaw_rad) * p.x() - std::sin(yaw_rad) * p.y() + shift.x(),
                         std::sin(yaw_rad) * p.x() + std::cos(yaw_rad) * p.y() + shift.y());
        };
        EXPECT_NEAR(intersection_over_union(mapped(a, move), mapped(b, move)), iou, 1e-6);

        const auto mirror = [](const Point& p) { return Point(p.x(), -p.y()); };
        EXPECT_NEAR(intersection_over_union(with_swapped_sides(mapped(a, mirror)),
                                            with_swapped_sides(mapped(b, mirror))),
                    iou, 1e-6);
        EXPECT_EQ(intersection_over_union(mapped(a, mirror), mapped(b, mirror)), 0.0);
    }
}

TEST(IntersectionOverUnionOfSimple, IsThatOfAnyLanes) {
    const LaneOutline circuit{kOuterClockwise, kInnerClockwise, true};
    EXPECT_NEAR(intersection_over_union_of_simple(circuit, circuit), 1.0, 1e-12);
    EXPECT_NEAR(intersection_over_union_of_simple(straight(10), straight(10, 1.0)), 3.0 / 5.0, 1e-12);
    EXPECT_EQ(intersection_over_union_of_simple(straight(10), with_swapped_sides(straight(10))), 0.0);
    EXPECT_EQ(intersection_over_union_of_simple(straight(10), straight(10, 9.0)), 0.0);
    EXPECT_EQ(intersection_over_union_of_simple(straight(10), {{{0, 0}}, {{0, 1}, {1, 1}}}), 0.0);
    boost::random::uniform_real_distribution<double> jitter_m(-0.9, 0.9);
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Random random(seed);
        // Boundaries that stay on their side of the x axis, so that no outline crosses itself.
        const auto lane = [&] {
            LaneOutline outline;
            for (int i = 0; i < 8; ++i) {
                const double left_m = 2.0 + jitter_m(random);
                outline.left.emplace_back(3.0 * i + jitter_m(random), left_m);
                const double right_m = -2.0 + jitter_m(random);
                outline.right.emplace_back(3.0 * i + jitter_m(random), right_m);
            }
            return outline;
        };
        const LaneOutline a = lane();
        const LaneOutline b = lane();
        EXPECT_NEAR(intersection_over_union_of_simple(a, b), intersection_over_union(a, b), 1e-6);
        EXPECT_NEAR(intersection_over_union_of_simple(b, circuit), intersection_over_union(b, circuit), 1e-6);
    }
}

/// Winding number of closed loops around a point, counter-clockwise positive.
int winding(const std::vector<Point>& loop, const Point& about) {
    int turns = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Point& from = loop[i];
        const Point& to = loop[(i + 1) % loop.size()];
        const double side = cross(to - from, about - from);
        if (from.y() <= about.y() && to.y() > about.y() && side > 0.0) ++turns;
        if (from.y() > about.y() && to.y() <= about.y() && side < 0.0) --turns;
    }
    return turns;
}

TEST(LaneAreaProperty, OfAnyRectilinearOutlineIsTheNumberOfCellsWithClockwiseTurns) {
    constexpr int kCells = 6;
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Random random(seed);
        boost::random::uniform_int_distribution<int> coordinate(0, kCells);
        boost::random::uniform_int_distribution<int> count(1, 6);
        // Corners alternate between x and y; the last one is in line with the first one, so the loop closes.
        std::vector<Point> loop{Point(coordinate(random), coordinate(random))};
        const int corners = count(random);
        for (int i = 0; i < corners; ++i) {
            loop.emplace_back(coordinate(random), loop.back().y());
            loop.emplace_back(loop.back().x(), coordinate(random));
        }
        loop.emplace_back(loop.front().x(), loop.back().y());

        LaneOutline lane;
        const auto split = static_cast<std::ptrdiff_t>(loop.size() / 2);
        lane.left.assign(loop.begin(), loop.begin() + split);
        lane.right.assign(loop.begin() + split, loop.end());
        std::ranges::reverse(lane.right);
        int cells = 0;
        for (int x = 0; x < kCells; ++x) {
            for (int y = 0; y < kCells; ++y) cells += winding(loop, Point(x + 0.5, y + 0.5)) < 0 ? 1 : 0;
        }
        EXPECT_NEAR(lane_area_m2(lane), cells, 1e-9);
    }
}

}  // namespace
}  // namespace conelane
