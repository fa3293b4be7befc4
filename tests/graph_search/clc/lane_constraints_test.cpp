
#include "graph_search/clc/deciders.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/lane_constraints_reference.hpp"

#include <boost/random/uniform_01.hpp>

namespace conelane {
namespace {

/// Both boundaries, grown by LaneConstraints and also stored as plain points.
class GrowingLane {
  public:
    GrowingLane(const Point& left, const Point& right, WidthBacktracking rule = WidthBacktracking::proven)
        : vertices{{{left}, {right}}} {
        constraints.reset(left, right, bounds, rule);
    }

    void push(Side side, const Point& point) {
        std::vector<Point>& own = vertices[side];
        const bool turn_allowed =
            own.size() < 2 || turning_measure(own.back() - own[own.size() - 2], point - own.back()) <
                                  turning_measure(bounds.phi_max_rad);
        constraints.push(side, point, turn_allowed);
        own.push_back(point);
    }
    void pop(Side side) {
        constraints.pop(side);
        vertices[side].pop_back();
    }
    bool feasible_by_definition() const {
        return satisfies_constraints(vertices[kLeft], vertices[kRight], bounds);
    }
    const LaneConstraints::State& state() const { return constraints.state(); }

    LaneBounds bounds;
    std::array<std::vector<Point>, 2> vertices;
    LaneConstraints constraints;
};

// Lemma 2: the line between the last points crosses the left boundary until the right one catches up.
TEST(LaneConstraints, ALineBetweenTheLastPointsThatCrossesCanBeUndone) {
    GrowingLane lane({0, 2}, {0, -2});
    lane.push(kLeft, {4, 0.9});
    lane.push(kLeft, {5, 4});
    EXPECT_TRUE(lane.state().end_line_meets);
    EXPECT_FALSE(lane.state().feasible);
    EXPECT_FALSE(lane.feasible_by_definition());
    EXPECT_FALSE(lane.state().hopeless);
    EXPECT_FALSE(lane.state().backtrack(false, true));
    EXPECT_TRUE(lane.state().backtrack(false, false));
    lane.push(kRight, {5, -2});
    EXPECT_TRUE(lane.state().feasible);
    EXPECT_TRUE(lane.feasible_by_definition());
}

// Lemma 3, third case.
TEST(LaneConstraints, ASideThatRanAheadNeedsTheOther) {
    GrowingLane lane({0, 2}, {0, -2});
    lane.push(kLeft, {5, 2});
    lane.push(kLeft, {10, 2});
    EXPECT_TRUE(lane.state().needs[kRight]);
    EXPECT_FALSE(lane.state().needs[kLeft]);
    EXPECT_FALSE(lane.state().backtrack(false, true));
    EXPECT_TRUE(lane.state().backtrack(true, false));
}

// Lemma 3, first case, as the search applies it: both sides have passed the bulge.
TEST(LaneConstraints, APlaceThatIsTooWideIsGivenUpOnceLeftBehind) {
    for (const auto rule : {WidthBacktracking::proven, WidthBacktracking::left_behind}) {
        GrowingLane lane({0, 2}, {0, -2}, rule);
        lane.push(kLeft, {3.5, 5});
        lane.push(kLeft, {7, 2});
        lane.push(kRight, {3.5, -2});
        EXPECT_FALSE(lane.state().hopeless);
        lane.push(kRight, {7, -2});
        EXPECT_EQ(lane.state().hopeless, rule == WidthBacktracking::left_behind);
        EXPECT_FALSE(lane.state().feasible);
    }
}

/// Random lanes: mostly plausible, with some wild points.
class Walk {
  public:
    explicit Walk(unsigned seed) : random_(seed), curvature_(uniform(-0.08, 0.08)) {}

    double uniform(double low, double high) {
        return low + (high - low) * boost::random::uniform_01<double>()(random_);
    }
    Side side() { return uniform(0, 1) < 0.5 ? kLeft : kRight; }
    Point next(const std::vector<Point>& own, Side side) {
        if (uniform(0, 1) < 0.08) return own.back() + Point(uniform(-5, 5), uniform(-5, 5));
        const double s = 3.3 * static_cast<double>(own.size());
        const double heading_rad = curvature_ * s;
        const Point centre = curvature_ == 0.0
                                 ? Point(s, 0)
                                 : Point(std::sin(heading_rad), 1 - std::cos(heading_rad)) / curvature_;
        const Point normal(-std::sin(heading_rad), std::cos(heading_rad));
        const double offset_m = side == kLeft ? uniform(1.3, 2.6) : uniform(-2.6, -1.3);
        return centre + offset_m * normal;
    }

  private:
    boost::random::mt19937_64 random_;
    double curvature_;
};

// At every step, the online deciders agree with the definition of the constraints, and Lemmata 1 to 3 hold: a
// hopeless lane stays infeasible, and a lane that needs one side stays infeasible until that side grows. The
// exceptions in the lemmata occur.
TEST(LaneConstraints, AgreeWithTheirDefinitionAndKeepTheirPromisesOnRandomLanes) {
    int feasible = 0;
    int hopeless = 0;
    int ends_uncrossed = 0;
    int needs_met = 0;
    for (unsigned seed = 0; seed < 12000; ++seed) {
        SCOPED_TRACE(seed);
        Walk walk(seed);
        GrowingLane lane({0, 2}, {0, -2});
        for (int step = 0; step < 16; ++step) {
            const LaneConstraints::State before = lane.state();
            const Side side = walk.side();
            lane.push(side, walk.next(lane.vertices[side], side));
            const LaneConstraints::State& now = lane.state();
            ASSERT_EQ(now.feasible, lane.feasible_by_definition()) << "step " << step;
            if (before.hopeless) {
                ASSERT_FALSE(now.feasible);
            }
            for (const Side needed : {kLeft, kRight}) {
                if (before.needs[needed] && side != needed) {
                    ASSERT_FALSE(now.feasible);
                }
                if (before.needs[needed] && side == needed && now.feasible) ++needs_met;
            }
            if (before.end_line_meets && now.feasible) ++ends_uncrossed;
            feasible += now.feasible ? 1 : 0;
            hopeless += now.hopeless ? 1 : 0;
        }
    }
    EXPECT_GT(feasible, 10000);
    EXPECT_GT(hopeless, 10000);
    EXPECT_GT(needs_met, 100);
    EXPECT_GT(ends_uncrossed, 5);
}

// A lane that is not hopeless must not be given up: a push that was undone has no effect.
TEST(LaneConstraints, ArePutBackByPop) {
    for (unsigned seed = 0; seed < 300; ++seed) {
        SCOPED_TRACE(seed);
        Walk walk(seed);
        GrowingLane lane({0, 2}, {0, -2});
        std::vector<Side> pushed;
        for (int step = 0; step < 60; ++step) {
            if (!pushed.empty() && walk.uniform(0, 1) < 0.45) {
                lane.pop(pushed.back());
                pushed.pop_back();
            } else {
                pushed.push_back(walk.side());
                lane.push(pushed.back(), walk.next(lane.vertices[pushed.back()], pushed.back()));
            }
            ASSERT_EQ(lane.state().feasible, lane.feasible_by_definition()) << "step " << step;
        }
    }
}

TEST(Closing, ARingCanBeClosedAndAnArcCannot) {
    const LaneBounds bounds;
    EXPECT_TRUE(can_be_closed(tests::ring(8, 14), tests::ring(12, 18), 5.5, bounds));
    EXPECT_TRUE(can_be_closed(tests::ring(12, 18), tests::ring(8, 14), 5.5, bounds));
    EXPECT_FALSE(can_be_closed(tests::ring(8, 14, 0.0, 4.0), tests::ring(12, 18, 0.0, 4.0), 5.5, bounds));
    EXPECT_FALSE(can_be_closed(tests::ring(8, 14), tests::ring(15, 20), 5.5, bounds)) << "too wide";
    EXPECT_FALSE(can_be_closed(tests::ring(8, 14), tests::ring(10, 18), 5.5, bounds)) << "too narrow";
    EXPECT_FALSE(can_be_closed(tests::ring(1, 2), tests::ring(4, 8), 5.5, bounds))
        << "two points are no ring";
}

TEST(Closing, OfBoundariesSideBySideIsNoLane) {
    std::vector<Point> left = tests::ring(1.5, 8);
    std::vector<Point> right = tests::ring(1.5, 8);
    for (Point& point : right) point += Point(6.0, 0.0);
    LaneBounds wide{.w_max_m = 20.0};
    EXPECT_FALSE(can_be_closed(left, right, 5.5, wide));
}

}  // namespace
}  // namespace conelane
