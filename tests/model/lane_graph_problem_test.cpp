// The numbers of a problem, for a lane that can be followed by hand.

#include "conelane/lane_graph_problem.hpp"

#include "tests/support/cones_at.hpp"
#include "tests/support/six_cone_lane.hpp"

namespace conelane {
namespace {

using tests::six_cone_lane;

constexpr double kRounding = 1e-9;

const LaneGraph kLane{{{0, 1}, {1, 2}, {3, 4}, {4, 5}}};

std::size_t edge_number(const LaneGraphProblem& problem, std::size_t i, std::size_t j) {
    const auto edge = std::ranges::find_if(
        problem.edges, [&](const ProblemEdge& candidate) { return candidate.i == i && candidate.j == j; });
    return static_cast<std::size_t>(edge - problem.edges.begin());
}
const ProblemEdge& edge(const LaneGraphProblem& problem, std::size_t i, std::size_t j) {
    return problem.edges.at(edge_number(problem, i, j));
}
const ProblemTurn& turn(const LaneGraphProblem& problem, std::size_t i, std::size_t middle, std::size_t k) {
    const std::size_t first = edge_number(problem, std::min(i, middle), std::max(i, middle));
    const std::size_t second = edge_number(problem, std::min(k, middle), std::max(k, middle));
    return *std::ranges::find_if(problem.turns, [&](const ProblemTurn& candidate) {
        return candidate.edge_i == first && candidate.edge_k == second && candidate.middle == middle;
    });
}
/// Of the edges 0 - 1 and 3 - 4.
bool in_conflict(const LaneGraphProblem& problem, const Edge& a = {0, 1}, const Edge& b = {3, 4}) {
    return std::ranges::count(problem.conflicts,
                              std::pair(edge_number(problem, a.i, a.j), edge_number(problem, b.i, b.j))) > 0;
}

TEST(LaneGraphProblem, EdgesCostWhatTheyAreOffTheExpected) {
    const LaneGraphProblem problem = make_problem(six_cone_lane(), {});
    const ProblemEdge& along = edge(problem, 0, 1);
    EXPECT_NEAR(along.spacing_cost, 0.0, kRounding);
    EXPECT_NEAR(along.heading_cost, 0.0, kRounding);
    EXPECT_NEAR(along.cost, -1.0, kRounding);
    EXPECT_TRUE(along.along_heading);
    // Its middle is 1 m ahead of the car.
    const ProblemEdge& across = edge(problem, 0, 3);
    EXPECT_NEAR(across.spacing_cost, std::pow(0.3 / 1.7, 4), kRounding);
    EXPECT_NEAR(across.heading_cost, std::pow(3.5, 4), kRounding);
    EXPECT_NEAR(across.cost, 0.4 * across.spacing_cost + 1.2 * across.heading_cost - 1.0, kRounding);
    EXPECT_FALSE(across.along_heading) << "near the car, but across its way";
    EXPECT_NEAR(objective(problem, kLane), -4.0, kRounding);
}

/// Cone 1 is 4.55 m from the car, which is as far as the edge 1 - 2 is.
TEST(LaneGraphProblem, AValueOnItsLimitIsWithinIt) {
    RldParameters parameters;
    parameters.d_h = parameters.d_near = 4.55;
    const LaneGraphProblem problem = make_problem(six_cone_lane(), parameters);
    EXPECT_TRUE(edge(problem, 1, 2).along_heading);
    EXPECT_THAT(problem.near, ElementsAre(true, true, false, true, true, false));
    parameters.d_h = parameters.d_near = 4.54;
    const LaneGraphProblem smaller = make_problem(six_cone_lane(), parameters);
    EXPECT_FALSE(edge(smaller, 1, 2).along_heading);
    EXPECT_THAT(smaller.near, ElementsAre(true, false, false, true, false, false));
}

/// The car looks along +y: cones to its left have a smaller x.
TEST(LaneGraphProblem, NearConesAreByTheCarsAxis) {
    Scene scene =
        tests::cones_at({{-1.5, 2.0}, {1.5, 2.0}, {-4.4, 3.0}, {4.6, 3.0}, {-4.4, -1.0}, {0.0, 9.0}});
    scene.pose.yaw_rad = std::numbers::pi / 2;
    RldParameters parameters{.d_near = 8.0};
    EXPECT_THAT(make_problem(scene, parameters).near, ElementsAre(true, true, true, true, true, false));
    parameters.d_side = 4.5;
    EXPECT_THAT(make_problem(scene, parameters).near, ElementsAre(true, true, true, false, true, false));
}

TEST(LaneGraphProblem, AnEdgeWithoutLengthIsNeverAllowed) {
    Scene scene = six_cone_lane();
    scene.cones.push_back({6, scene.cones[0].position});
    RldParameters parameters;
    parameters.d_e = 1.0;  // then a length of 0 would cost as little as one of 2 m
    EXPECT_TRUE(edge(make_problem(scene, parameters, EdgeExtent::all_pairs), 0, 6).high_cost);
    const LaneGraphProblem candidates = make_problem(scene, parameters);
    EXPECT_EQ(edge_number(candidates, 0, 6), candidates.edges.size());
}

TEST(LaneGraphProblem, EdgesThatAreTooCloseConflictExceptBetweenFacingCones) {
    RldParameters parameters{.d_min = 3.5};
    EXPECT_FALSE(in_conflict(make_problem(six_cone_lane(1.6), parameters)));
    parameters.d_min = 3.6;
    EXPECT_TRUE(in_conflict(make_problem(six_cone_lane(1.6), parameters)));
    EXPECT_FALSE(in_conflict(make_problem(six_cone_lane(), parameters)));
}

TEST(LaneGraphProblem, CrossingsConflictWhereTheyAreForbidden) {
    RldParameters parameters{.d_min = 0.0};
    EXPECT_FALSE(in_conflict(make_problem(six_cone_lane(), parameters), {1, 5}, {2, 4}));
    parameters.forbid_crossing = true;
    EXPECT_TRUE(in_conflict(make_problem(six_cone_lane(), parameters), {1, 5}, {2, 4}));
}

TEST(LaneGraphProblem, TurnsCostTheirAngleAndTheSharpestAreForbidden) {
    const LaneGraphProblem problem = make_problem(six_cone_lane(), {});
    EXPECT_NEAR(turn(problem, 0, 1, 2).cost, 0.0, kRounding);
    EXPECT_FALSE(turn(problem, 0, 1, 2).high_cost);
    const ProblemTurn& corner = turn(problem, 0, 1, 4);
    EXPECT_NEAR(corner.angle_cost, std::pow(std::numbers::pi / 2.0 / 0.9, 4), 1e-6);
    EXPECT_NEAR(corner.cost, 0.5 * corner.angle_cost, kRounding);
    EXPECT_TRUE(corner.high_cost);
}

TEST(LaneGraphProblem, OnlyFarConesAreTooFarApart) {
    RldParameters parameters{.d_max = 3.5};
    EXPECT_THAT(make_problem(six_cone_lane(), parameters).far_apart, testing::IsEmpty());
    parameters.d_max = 3.4;
    EXPECT_THAT(make_problem(six_cone_lane(), parameters).far_apart, ElementsAre(testing::Pair(2, 5)));
}

/// A turn costs only if both its edges are chosen.
TEST(LaneGraphProblem, TheObjectiveCountsTurnsThatAreTaken) {
    Scene scene = six_cone_lane();
    scene.cones[2].position = {4.2 + 3.2 * std::cos(0.45), 1.75 + 3.2 * std::sin(0.45)};
    const LaneGraphProblem problem = make_problem(scene, {});
    const double both = edge(problem, 0, 1).cost + edge(problem, 1, 2).cost;
    EXPECT_NEAR(objective(problem, {{{0, 1}, {1, 2}}}), both + 0.5 * std::pow(0.45 / 0.9, 4), kRounding);
    EXPECT_NEAR(objective(problem, {{{0, 1}, {3, 4}}}), -2.0, kRounding);
}

}  // namespace
}  // namespace conelane
