#include "graph_search/clc/lane_width.hpp"

#include "tests/support/testing.hpp"

#include <numeric>

#include <boost/random/uniform_01.hpp>

namespace conelane {
namespace {

constexpr double kWMax_m = 6.5;

TEST(LaneWidths, OfAStraightLaneAreItsWidth) {
    const std::vector<Point> left{{0, 2}, {4, 2}, {8, 2}};
    const std::vector<Point> right{{0, -2}, {4, -2}, {8, -2}};
    const LaneWidths widths = lane_widths(left, right);
    EXPECT_THAT(widths.of_vertex_m[kLeft], ElementsAre(4, 4, 4));
    EXPECT_THAT(widths.of_segment_m[kRight], ElementsAre(4, 4));
}

TEST(LaneWidths, AreMeasuredToSegmentsNotToVerticesOnly) {
    const std::vector<Point> left{{1, 3}, {5, 6}};
    const std::vector<Point> right{{0, 0}, {4, 0}};
    const LaneWidths widths = lane_widths(left, right);
    EXPECT_THAT(widths.of_vertex_m[kLeft], ElementsAre(DoubleEq(3), DoubleEq(std::sqrt(37))));
    EXPECT_THAT(widths.of_vertex_m[kRight][0], DoubleEq(std::sqrt(10)));
    EXPECT_THAT(widths.of_segment_m[kLeft], ElementsAre(DoubleEq(3)));
    EXPECT_THAT(widths.of_segment_m[kRight], ElementsAre(DoubleEq(3)));
}

TEST(LaneWidths, OfAClosedLaneIncludeTheClosingSegments) {
    const std::vector<Point> inner{{2, 2}, {-2, 2}, {-2, -2}, {2, -2}};
    const std::vector<Point> outer{{5, 5}, {-5, 5}, {-5, -5}, {5, -5}};
    const LaneWidths widths = lane_widths(inner, outer, true);
    EXPECT_THAT(widths.of_segment_m[kLeft], ElementsAre(3, 3, 3, 3));
    EXPECT_THAT(widths.of_segment_m[kRight], ElementsAre(3, 3, 3, 3));
}

double vertex_width_m(const OnlineLaneWidth& width, Side side, std::size_t vertex) {
    return std::sqrt(width.squared_vertex_widths_m2(side)[vertex]);
}

/// Mean of the widths of all vertices and segments, by definition.
double variance_of(const LaneWidths& widths) {
    std::vector<double> all_m;
    for (const Side side : {kLeft, kRight}) {
        all_m.insert(all_m.end(), widths.of_vertex_m[side].begin(), widths.of_vertex_m[side].end());
        all_m.insert(all_m.end(), widths.of_segment_m[side].begin(), widths.of_segment_m[side].end());
    }
    const double mean_m =
        std::accumulate(all_m.begin(), all_m.end(), 0.0) / static_cast<double>(all_m.size());
    double sum_m2 = 0.0;
    for (const double width_m : all_m) sum_m2 += (width_m - mean_m) * (width_m - mean_m);
    return sum_m2 / static_cast<double>(all_m.size());
}

// With two points a side, Algorithm 3 would fix the matching between the first points, because it comes
// before the first one that meets an end. But the third right point is nearer to the first left one.
TEST(OnlineLaneWidth, SeesWhatComesNearerAfterAMatchingWouldHaveBeenFixed) {
    OnlineLaneWidth width;
    width.reset({0, 0}, {0, -6}, kWMax_m);
    width.push(kLeft, {4, 0});
    width.push(kRight, {3, -6});
    EXPECT_DOUBLE_EQ(vertex_width_m(width, kLeft, 0), 6.0);
    width.push(kRight, {4, -3});
    EXPECT_DOUBLE_EQ(vertex_width_m(width, kLeft, 0), 5.0);
    EXPECT_DOUBLE_EQ(vertex_width_m(width, kLeft, 1), 3.0);
    EXPECT_NEAR(width.variance(),
                variance_of(lane_widths(std::vector<Point>{{0, 0}, {4, 0}},
                                        std::vector<Point>{{0, -6}, {3, -6}, {4, -3}})),
                1e-9);
    width.pop(kRight);
    EXPECT_DOUBLE_EQ(vertex_width_m(width, kLeft, 0), 6.0);
}

TEST(OnlineLaneWidth, TellsWhoCanHelpAVertexThatIsTooFar) {
    OnlineLaneWidth width;
    width.reset({0, 2}, {0, -2}, kWMax_m);
    width.push(kLeft, {5, 2});
    width.push(kLeft, {10, 2});
    // The left boundary is ahead: its last vertex is too far from the only right one, whose end is near.
    EXPECT_THAT(width.state().too_wide, ElementsAre(1, 0));
    EXPECT_FALSE(width.state().too_wide_behind);
    width.push(kRight, {5, -2});
    width.push(kRight, {10, -2});
    EXPECT_THAT(width.state().too_wide, ElementsAre(0, 0));
}

TEST(OnlineLaneWidth, TellsWhenBothBoundariesHaveLeftATooWidePlaceBehind) {
    OnlineLaneWidth width;
    width.reset({0, 2}, {0, -2}, kWMax_m);
    width.push(kLeft, {3, 6});
    width.push(kLeft, {6, 2});
    width.push(kRight, {3, -2});
    EXPECT_THAT(width.state().too_wide, ElementsAre(1, 0));
    EXPECT_FALSE(width.state().too_wide_behind) << "the right boundary still ends below the bulge";
    width.push(kRight, {6, -2});
    EXPECT_THAT(width.state().too_wide, ElementsAre(1, 0));
    EXPECT_TRUE(width.state().too_wide_behind);
}

/// A lane that grows and shrinks at random, with wild points among those of a winding lane.
class RandomLane {
  public:
    explicit RandomLane(unsigned seed) : random_(seed) { vertices_ = {{{{0, 2}}, {{0, -2}}}}; }

    double uniform(double low, double high) {
        return low + (high - low) * boost::random::uniform_01<double>()(random_);
    }
    Side random_side() { return uniform(0, 1) < 0.5 ? kLeft : kRight; }
    const std::vector<Point>& vertices(Side side) const { return vertices_[side]; }
    /// Nothing if the new segment would meet the other boundary.
    bool push(Side side) {
        std::vector<Point>& own = vertices_[side];
        const std::vector<Point>& other = vertices_[opposite(side)];
        const double progress = 3.5 * static_cast<double>(own.size());
        const double heading_rad = 0.35 * std::sin(progress / 9.0) + progress / 40.0;
        Point next = own.back() + 3.5 * Point(std::cos(heading_rad), std::sin(heading_rad)) +
                     Point(uniform(-1, 1), uniform(-1, 1));
        if (uniform(0, 1) < 0.15) next = own.back() + Point(uniform(-5, 5), uniform(-5, 5));
        const Segment segment{own.back(), next};
        if (segments_intersect(segment, {other.back(), other.back()})) return false;
        for (std::size_t i = 1; i < other.size(); ++i) {
            if (segments_intersect(segment, {other[i - 1], other[i]})) return false;
        }
        own.push_back(next);
        order_.push_back(side);
        return true;
    }
    bool empty() const { return order_.empty(); }
    Side pop() {
        const Side side = order_.back();
        order_.pop_back();
        vertices_[side].pop_back();
        return side;
    }

  private:
    boost::random::mt19937_64 random_;
    std::array<std::vector<Point>, 2> vertices_;
    std::vector<Side> order_;
};

TEST(OnlineLaneWidth, EqualsTheDefinitionAfterEveryStepOfARandomLane) {
    OnlineLaneWidth width;
    for (unsigned seed = 0; seed < 300; ++seed) {
        SCOPED_TRACE(seed);
        RandomLane lane(seed);
        width.reset(lane.vertices(kLeft).front(), lane.vertices(kRight).front(), kWMax_m);
        for (int step = 0; step < 60; ++step) {
            if (!lane.empty() && lane.uniform(0, 1) < 0.25) {
                width.pop(lane.pop());
            } else if (const Side side = lane.random_side(); lane.push(side)) {
                width.push(side, lane.vertices(side).back());
            }
            const LaneWidths expected = lane_widths(lane.vertices(kLeft), lane.vertices(kRight));
            double narrowest_m = kWMax_m;
            for (const Side side : {kLeft, kRight}) {
                for (std::size_t i = 0; i < expected.of_vertex_m[side].size(); ++i) {
                    ASSERT_NEAR(vertex_width_m(width, side, i), expected.of_vertex_m[side][i], 1e-6);
                    narrowest_m = std::min(narrowest_m, expected.of_vertex_m[side][i]);
                }
                for (const double width_m : expected.of_segment_m[side])
                    narrowest_m = std::min(narrowest_m, width_m);
                ASSERT_EQ(
                    width.state().too_wide[side],
                    std::ranges::count_if(expected.of_vertex_m[side], [](double w) { return w >= kWMax_m; }));
            }
            ASSERT_NEAR(std::min(std::sqrt(width.state().narrowest_squared), kWMax_m), narrowest_m, 1e-6);
            ASSERT_NEAR(width.variance(), variance_of(expected), 1e-6);
        }
    }
}

}  // namespace
}  // namespace conelane
