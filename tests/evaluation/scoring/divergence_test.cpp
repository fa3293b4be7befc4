#include "evaluation/scoring/divergence.hpp"

#include "conelane/invalid_input.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

/// Annotated along the x axis from -40 m to 80 m; the ground truth starts at x = 0.
const std::vector<Point> kStraight{{-40, 0}, {-20, 0}, {0, 0}, {40, 0}, {80, 0}};
const Point kStart(0, 0);

std::optional<double> on_straight(const std::vector<Point>& predicted) {
    return boundary_divergence_m(predicted, kStraight, false, kStart);
}

TEST(BoundaryDivergence, NoneOnTheBoundary) {
    EXPECT_FALSE(on_straight({{0, 0}, {4, 0.3}, {8, -0.3}, {12, 0}}));
    EXPECT_FALSE(on_straight({}));
}

TEST(BoundaryDivergence, AVertexIsOffBeyondOneMetre) {
    EXPECT_FALSE(on_straight({{0, 0}, {4, 0}, {8, 1.0}}));
    EXPECT_EQ(on_straight({{0, 0}, {4, 0}, {8, 1.001}}), 4.0);
    EXPECT_EQ(on_straight({{0, 0}, {4, 0}, {8, -1.001}, {12, 0}}), 4.0);
}

TEST(BoundaryDivergence, IsMeasuredFromTheFirstGroundTruthConeToTheLastFootBefore) {
    EXPECT_EQ(on_straight({{3, 0.5}, {9, 0.5}, {13, 5}}), 9.0);
    EXPECT_EQ(on_straight({{0, 5}, {4, 0}}), 0.0) << "no vertex before the first one off";
    EXPECT_EQ(on_straight({{-5, 0}, {-1, 5}}), 0.0) << "the last good foot lies behind the first cone";
}

TEST(BoundaryDivergence, AFootThatFallsBackMoreThanTwoMetresIsOff) {
    EXPECT_FALSE(on_straight({{0, 0}, {4, 0}, {8, 0}, {6, 0}}));
    EXPECT_EQ(on_straight({{0, 0}, {4, 0}, {8, 0}, {5.99, 0}}), 8.0);
}

TEST(BoundaryDivergence, AFootThatLeapsAheadOfTheChordIsOff) {
    // A hairpin: out along y = 0, back along y = 3.
    const std::vector<Point> hairpin{{0, 0}, {40, 0}, {40, 3}, {0, 3}};
    const auto on_hairpin = [&](const std::vector<Point>& predicted) {
        return boundary_divergence_m(predicted, hairpin, false, kStart);
    };
    // Chord 3 m allows 9 m: at x = 37 the way round is 3 + 3 + 3 m, at x = 36.9 a little more.
    EXPECT_FALSE(on_hairpin({{10, 0}, {20, 0}, {37, 0}, {37, 3}}));
    EXPECT_EQ(on_hairpin({{10, 0}, {20, 0}, {36.9, 0}, {36.9, 3}}), 36.9);
    EXPECT_EQ(on_hairpin({{4, 0}, {10, 0}, {10, 3}, {6, 3}}), 10.0);
    EXPECT_EQ(on_hairpin({{10, 3}, {6, 3}}), 0.0) << "the first vertex lies on the way back";
}

TEST(BoundaryDivergence, TheFirstVertexHasAWindowAboutTheFirstGroundTruthCone) {
    EXPECT_FALSE(on_straight({{-8, 0}, {-4, 0}}));
    EXPECT_EQ(on_straight({{-8.01, 0}, {-4, 0}}), 0.0);
    EXPECT_FALSE(on_straight({{12, 0}, {16, 0}}));
    EXPECT_EQ(on_straight({{12.01, 0}, {16, 0}}), 0.0);
}

/// A square course of 160 m, from (0, 0) counter-clockwise.
const std::vector<Point> kSquare{{0, 0}, {40, 0}, {40, 40}, {0, 40}};

TEST(BoundaryDivergence, PassingTheSeamOfAClosedCourseIsNoLeap) {
    // The ground truth starts at 150 m; the corner (0, 0) is the seam.
    const Point start(0, 10);
    const std::vector<Point> through{{0, 10}, {0, 5}, {0, 0}, {5, 0}, {10, 0}};
    EXPECT_FALSE(boundary_divergence_m(through, kSquare, true, start));
    std::vector<Point> off = through;
    off.emplace_back(15, 3);
    EXPECT_DOUBLE_EQ(boundary_divergence_m(off, kSquare, true, start).value(), 20.0);
    EXPECT_FALSE(boundary_divergence_m(std::vector<Point>{{0, 4}, {0, 0}}, kSquare, true, Point(2, 0)))
        << "the first vertex lies 6 m before the first cone, across the seam";
    EXPECT_EQ(boundary_divergence_m(std::vector<Point>{{0, 7}, {0, 3}}, kSquare, true, Point(2, 0)), 0.0)
        << "9 m before it is outside the window";
}

TEST(BoundaryDivergence, GrowsOverMoreThanOneRound) {
    std::vector<Point> two_rounds;
    for (int round = 0; round < 2; ++round) {
        for (const Point& corner : kSquare) two_rounds.push_back(corner);
    }
    EXPECT_FALSE(boundary_divergence_m(two_rounds, kSquare, true, kStart));
    two_rounds.emplace_back(20, 20);
    EXPECT_DOUBLE_EQ(boundary_divergence_m(two_rounds, kSquare, true, kStart).value(), 280.0);
}

TEST(BoundaryDivergence, AClosedCourseDrivenBackwardsIsOff) {
    EXPECT_EQ(boundary_divergence_m(std::vector<Point>{{20, 0}, {16, 0}}, kSquare, true, Point(20, 0)), 0.0);
}

TEST(BoundaryDivergence, OnAnOpenCourseTheEndsAreFarApart) {
    EXPECT_EQ(boundary_divergence_m(std::vector<Point>{{0, 4}, {0, 0}}, kSquare, false, kStart), 0.0)
        << "the edge from (0, 40) to (0, 0) is not annotated";
}

TEST(BoundaryDivergence, NeedsAnAnnotatedBoundary) {
    EXPECT_THROW((void)boundary_divergence_m(std::vector<Point>{{0, 0}}, {}, true, kStart), InvalidInput);
}

const TrackBoundaries kTrack{{{-40, 2}, {80, 2}}, {{-40, -2}, {80, -2}}, false};
const LaneOutline kGroundTruth{{{0, 2}, {40, 2}}, {{0, -2}, {40, -2}}};

TEST(LaneDivergence, IsTheSmallerOneOfTheSidesThatAreOff) {
    EXPECT_FALSE(divergence_m(kGroundTruth, kGroundTruth, kTrack));
    const std::vector<Point> left_off{{0, 2}, {12, 2}, {16, 6}};
    const std::vector<Point> right_off{{0, -2}, {8, -2}, {16, -6}};
    EXPECT_EQ(divergence_m({left_off, kGroundTruth.right}, kGroundTruth, kTrack), 12.0);
    EXPECT_EQ(divergence_m({kGroundTruth.left, right_off}, kGroundTruth, kTrack), 8.0);
    EXPECT_EQ(divergence_m({left_off, right_off}, kGroundTruth, kTrack), 8.0);
}

TEST(LaneDivergence, HoldsEachSideAgainstItsOwnBoundary) {
    EXPECT_EQ(divergence_m({kGroundTruth.right, kGroundTruth.left}, kGroundTruth, kTrack), 0.0);
    EXPECT_EQ(divergence_m({{{0, 2}, {4, 2}, {8, -2}}, kGroundTruth.right}, kGroundTruth, kTrack), 4.0);
}

TEST(LaneDivergence, AnEmptySideIsNotOff) {
    EXPECT_FALSE(divergence_m({kGroundTruth.left, {}}, kGroundTruth, kTrack));
}

}  // namespace
}  // namespace conelane
