// The side of an edge near the car, for its color cost: on a straight, and in bends, where neither the car's
// axis nor the line of the edge is enough.

#include "conelane/check.hpp"
#include "conelane/lane_graph_problem.hpp"
#include "tests/support/random_scenes.hpp"

namespace conelane {
namespace {

constexpr ConeColor kBlue = ConeColor::blue;
constexpr ConeColor kYellow = ConeColor::yellow;

/// Cost of the edge between two cones; the car is at the origin and looks along +x.
double color_cost(const Point& from, ConeColor from_color, const Point& to, ConeColor to_color) {
    Scene scene;
    scene.cones = {{1, from, from_color}, {2, to, to_color}};
    return make_problem(scene, {}).edges.at(0).color_cost;
}

/// As a boundary of that color, from either end.
double color_cost(ConeColor color, const Point& from, const Point& to) {
    const double cost = color_cost(from, color, to, color);
    EXPECT_EQ(color_cost(to, color, from, color), cost);
    return cost;
}

TEST(ColorCost, IsOnTheWrongSideOfAStraightOnly) {
    EXPECT_EQ(color_cost(kBlue, {2, -1.5}, {5, -1.5}), 1.0);
    EXPECT_EQ(color_cost(kYellow, {2, -1.5}, {5, -1.5}), 0.0);
    EXPECT_EQ(color_cost(kBlue, {2, 1.5}, {5, 1.5}), 0.0);
    EXPECT_EQ(color_cost(kYellow, {2, 1.5}, {5, 1.5}), 1.0);
    for (const ConeColor neutral : {ConeColor::orange, ConeColor::unknown}) {
        EXPECT_EQ(color_cost(neutral, {2, 1.5}, {5, 1.5}), 0.0);
        EXPECT_EQ(color_cost(neutral, {2, -1.5}, {5, -1.5}), 0.0);
    }
}

TEST(ColorCost, SparesBothBoundariesOfABend) {
    // The outer boundary of a bend to the right crosses the axis, but the car is right of its line.
    EXPECT_EQ(color_cost(kBlue, {4.5, 1.0}, {6.5, -1.6}), 0.0);
    // The inner one is right of the axis, but its line has turned so far that the car is to its right.
    EXPECT_EQ(color_cost(kYellow, {3.0, -2.0}, {4.4, -4.6}), 0.0);
    // The same mirrored: a bend to the left.
    EXPECT_EQ(color_cost(kYellow, {4.5, -1.0}, {6.5, 1.6}), 0.0);
    EXPECT_EQ(color_cost(kBlue, {3.0, 2.0}, {4.4, 4.6}), 0.0);
}

TEST(ColorCost, OfAnEdgeOfBothColorsIsOneFarAwayAndTwoBesideTheCar) {
    EXPECT_EQ(color_cost({20, 0}, kBlue, {23, 0}, kYellow), 1.0);
    EXPECT_EQ(color_cost({2, 1.5}, kBlue, {5, 1.5}, kYellow), 2.0);
    EXPECT_EQ(color_cost({20, 1.5}, kYellow, {23, 1.5}, kYellow), 0.0);  // too far for a side
}

/// Blue with 0.7 and yellow with 0.1 at one end, with 0.4 and 0.5 at the other.
TEST(ColorCost, OfProbabilitiesIsTheExpectedCost) {
    const auto cost = [](const Point& from, const Point& to) {
        Scene scene;
        scene.cones = {{1, from, ConeColor::yellow}, {2, to, ConeColor::yellow}};  // labels have no effect
        scene.cones[0].color_probabilities = {.unknown = 0.2, .blue = 0.7, .yellow = 0.1};
        scene.cones[1].color_probabilities = {.blue = 0.4, .yellow = 0.5, .orange = 0.1};
        return make_problem(scene, {}).edges.at(0).color_cost;
    };
    constexpr double kOfBoth = 0.7 * 0.5 + 0.1 * 0.4;
    EXPECT_NEAR(cost({20, 1.5}, {23, 1.5}), kOfBoth, 1e-12);
    EXPECT_NEAR(cost({2, -1.5}, {5, -1.5}), kOfBoth + 0.82, 1e-12);  // 1 - 0.3 * 0.6: one is blue
    EXPECT_NEAR(cost({2, 1.5}, {5, 1.5}), kOfBoth + 0.55, 1e-12);    // 1 - 0.9 * 0.5: one is yellow
}

/// For every edge of a problem alone, the checker's cost is the problem's.
TEST(ColorCost, IsThatOfTheIndependentChecker) {
    std::size_t faults = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        Scene scene = tests::random_scene(seed, 10);
        for (std::size_t i = 0; i < scene.cones.size(); ++i) {
            scene.cones[i].color = (i + seed) % 3 == 0 ? kBlue : kYellow;
            if (seed % 2 == 0) continue;
            const double blue = static_cast<double>((7 * i + seed) % 10) / 10.0;
            scene.cones[i].color_probabilities = {.unknown = 0.1, .blue = blue, .yellow = 0.9 - blue};
        }
        RldParameters parameters{.w_color = 100.0};
        const LaneGraphProblem problem = make_problem(scene, parameters);
        for (const ProblemEdge& edge : problem.edges) {
            const CheckReport report = check(scene, parameters, LaneGraph{{{edge.i, edge.j}}});
            ASSERT_TRUE(report.objective);
            ASSERT_NEAR(*report.objective, edge.cost, 1e-9) << "seed " << seed;
            if (edge.color_cost > 0.0) ++faults;
        }
    }
    EXPECT_GT(faults, 100U);
}

}  // namespace
}  // namespace conelane
