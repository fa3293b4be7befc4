// The costs of a lane's shape, on lanes that can be followed by hand, and the same numbers from the
// independent checker, which computes them by definition.

#include "model/shape_costs.hpp"

#include "solvers/core_entries.hpp"
#include "tests/support/agreement.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/random_scenes.hpp"

namespace conelane {
namespace {

using tests::cones_at;

/// Only the facing cost, for a lane 4 m wide; edges cost nothing else.
RldParameters facing_parameters() {
    RldParameters parameters;
    parameters.w_s = parameters.w_t = parameters.w_p = parameters.w_b = 0.0;
    parameters.facing_weight = 1.0;
    parameters.lane_width_m = 4.0;
    parameters.facing_distance_m = 2.0;
    parameters.facing_angle_rad = 0.5;
    parameters.facing_length_m = 2.0;
    return parameters;
}

/// The problem's cost, after a test that the checker's is equal.
double facing_cost(const Scene& scene, const RldParameters& parameters, std::size_t i, std::size_t j) {
    const double checked = *check(scene, parameters, LaneGraph{{{i, j}}}).objective;
    for (const ProblemEdge& edge : make_problem(scene, parameters).edges) {
        if (edge.i != i || edge.j != j) continue;
        EXPECT_NEAR(checked, edge.facing_cost, 1e-12);
        return edge.facing_cost;
    }
    ADD_FAILURE() << "there is no such edge";
    return -1.0;
}

TEST(Unevenness, IsTheSquaredDifferenceInUnitsOfTheSpacingThreshold) {
    RldParameters parameters{.d_t = 2.0};
    EXPECT_EQ(unevenness(3.0, 3.0, parameters), 0.0);
    EXPECT_EQ(unevenness(3.0, 4.0, parameters), 0.25);
    EXPECT_EQ(unevenness(4.0, 3.0, parameters), 0.25);
}

TEST(FacingCost, IsZeroIfTheLaneHasTheExpectedWidth) {
    const Scene lane = cones_at({{2, 2}, {5, 2}, {2, -2}, {5, -2}});
    EXPECT_NEAR(facing_cost(lane, facing_parameters(), 0, 1), 0.0, 1e-12);
    EXPECT_NEAR(facing_cost(lane, facing_parameters(), 2, 3), 0.0, 1e-12);
}

TEST(FacingCost, GrowsWithWidthOffsetAngleAndLength) {
    // 1 m too wide: (1 / 2)^2.
    EXPECT_NEAR(facing_cost(cones_at({{2, 2}, {5, 2}, {2, -3}, {5, -3}}), facing_parameters(), 0, 1), 0.25,
                1e-12);
    // 1 m farther along.
    EXPECT_NEAR(facing_cost(cones_at({{2, 2}, {5, 2}, {3, -2}, {6, -2}}), facing_parameters(), 0, 1), 0.25,
                1e-12);
    // Turned about its middle by an angle with sine 0.3: (0.3 / 0.5)^2.
    const double ahead = 1.5 * std::sqrt(1.0 - 0.09);
    const Scene turned = cones_at({{2, 2}, {5, 2}, {3.5 - ahead, -2.45}, {3.5 + ahead, -1.55}});
    EXPECT_NEAR(facing_cost(turned, facing_parameters(), 0, 1), 0.36, 1e-12);
    // 1 m longer: (1 / 2)^2, for the longer one as for the shorter.
    const Scene unlike = cones_at({{2, 2}, {5, 2}, {1.5, -2}, {5.5, -2}});
    EXPECT_NEAR(facing_cost(unlike, facing_parameters(), 0, 1), 0.25, 1e-12);
    EXPECT_NEAR(facing_cost(unlike, facing_parameters(), 2, 3), 0.25, 1e-12);
}

TEST(NearEndFit, IsBestHalfALaneBesideTheCar) {
    RldParameters parameters{.d_t = 2.0, .lane_width_m = 4.0};
    Scene scene;
    for (const double side : {1.0, -1.0}) {
        EXPECT_EQ(near_end_fit(scene, {3, side * 2}, parameters), 1.0);
        EXPECT_EQ(near_end_fit(scene, {-1, side * 3}, parameters), 0.75);
        EXPECT_EQ(near_end_fit(scene, {1, side * 1}, parameters), 0.75);
        EXPECT_EQ(near_end_fit(scene, {1, side * 7}, parameters), 0.0);
    }
    scene.pose.yaw_rad = 0.5 * std::numbers::pi;
    EXPECT_NEAR(near_end_fit(scene, {2, 0}, parameters), 1.0, 1e-12);
}

/// A straight lane with uneven spacing: its only costs are the near ends and the unevenness.
TEST(ShapeCosts, AddUpOnALaneByHand) {
    const Scene lane = cones_at({{2, 2}, {4, 2}, {7, 2}, {2, -2}, {4, -2}, {7, -2}});
    RldParameters parameters{.d_t = 2.0, .lane_width_m = 4.0};
    parameters.w_s = parameters.w_t = parameters.w_p = parameters.w_b = 0.0;
    parameters.unevenness_weight = 3.0;
    parameters.near_end_weight = 0.5;
    parameters.d_near = 3.0;
    const LaneGraph graph{{{0, 1}, {1, 2}, {3, 4}, {4, 5}}};
    const double expected = 2 * 3.0 * 0.25 - 2 * 0.5;
    EXPECT_NEAR(objective(make_problem(lane, parameters), graph), expected, 1e-12);
    EXPECT_NEAR(*check(lane, parameters, graph).objective, expected, 1e-12);
}

/// Two cones at one place, and an edge of 0.2 m beside them at exactly the expected width: nothing faces an
/// edge without a direction.
TEST(ShapeCosts, AnEdgeWithoutLengthIsFacedByNothing) {
    Scene scene = tests::cones_at({{2.0, 0.0}, {2.0, 0.0}, {1.9, 0.5}, {2.1, 0.5}});
    RldParameters parameters{.d_e = 0.2, .facing_weight = 1.0, .lane_width_m = 0.5};
    parameters.facing_distance_m = parameters.facing_length_m = 2.0;
    const LaneGraphProblem problem = make_problem(scene, parameters, EdgeExtent::all_pairs);
    ASSERT_EQ(problem.edges.front().j, 1U);
    EXPECT_EQ(problem.edges.front().facing_cost, 1.0);
}

TEST(ShapeCosts, ComeByHandWhereThereAreNone) {
    EXPECT_TRUE(has_shape_costs(with_shape_costs({})));
    RldParameters own{.facing_weight = 0.3};
    const RldParameters same = with_shape_costs(own);
    EXPECT_EQ(same.facing_weight, 0.3);
    EXPECT_EQ(same.unevenness_weight, 0.0);
    EXPECT_EQ(same.s_crit, RldParameters{}.s_crit);
}

/// Each edge alone, and every lane graph that is best for some weights, has the checker's cost. This includes
/// the near ends, which the problem distributes over edges and turns.
TEST(ShapeCosts, AreThoseOfTheIndependentChecker) {
    std::size_t faced = 0;
    std::size_t lanes = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene = tests::random_scene(seed, 9);
        RldParameters parameters{
            .unevenness_weight = 0.7, .facing_weight = 1.3, .near_end_weight = seed % 2 == 0 ? 0.9 : 4.0};
        const LaneGraphProblem all = make_problem(scene, parameters, EdgeExtent::all_pairs);
        tests::expect_edge_costs_confirmed(all, scene, parameters);
        const LaneGraphProblem problem = make_problem(scene, parameters);
        tests::expect_edge_costs_confirmed(problem, scene, parameters);
        for (const ProblemEdge& edge : problem.edges) faced += edge.facing_cost < 1.0 ? 1 : 0;
        const RldReport best = make_exhaustive_solver()->solve(problem, {});
        if (!best.lane_graph) continue;
        ++lanes;
        EXPECT_NEAR(*check(scene, parameters, *best.lane_graph).objective, *best.objective, 1e-9);
        EXPECT_NEAR(objective(problem, *best.lane_graph), *best.objective, 1e-9);
    }
    EXPECT_GT(faced, 100U);
    EXPECT_GT(lanes, 20U);
}

}  // namespace
}  // namespace conelane
