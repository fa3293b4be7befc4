// The beam searches that the exact searches are compared with.

#include "experiments/studies/beams.hpp"

#include "conelane/rld_parameter_sets.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "solvers/strip/strip_solver.hpp"
#include "tests/support/learned_costs.hpp"
#include "tests/support/strip_scenes.hpp"

namespace conelane::experiments {
namespace {

/// (29), shape costs, and learned costs with edges over gaps.
std::vector<RldParameters> objectives(std::uint64_t seed) {
    RldParameters learned{.d_gap = 9.0,
                          .learned_costs = tests::random_learned_costs(seed, seed % 2 == 0 ? 0 : 3)};
    return {RldParameters{}, with_shape_costs({}), learned};
}

/// Where nothing is left out, the cheapest is the optimum, and there is none where there is no lane graph.
TEST(LaneGraphBeam, ThatLeavesNothingOutFindsTheOptimum) {
    const std::unique_ptr<RldSolver> solver = make_path_pair_solver();
    int with_lane = 0;
    int without = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        for (const RldParameters& parameters : objectives(seed)) {
            SCOPED_TRACE(testing::Message() << "seed " << seed);
            const LaneGraphProblem problem = make_problem(tests::random_scene(seed, 9), parameters);
            const RldReport optimum = solver->solve(problem, {});
            const auto found = beam_lane_graph(problem, 1'000'000);
            ASSERT_EQ(found.has_value(), optimum.status == SolveStatus::optimal);
            if (!found) {
                ++without;
                continue;
            }
            ++with_lane;
            EXPECT_TRUE(is_feasible(problem, *found));
            EXPECT_NEAR(objective(problem, *found), *optimum.objective, 1e-9);
        }
    }
    EXPECT_GT(with_lane, 40);
    EXPECT_GT(without, 5);
}

/// A narrow one misses optima, but what it finds is a lane graph.
TEST(LaneGraphBeam, ThatIsNarrowMissesOptima) {
    const std::unique_ptr<RldSolver> solver = make_path_pair_solver();
    int worse = 0;
    int found_some = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const LaneGraphProblem problem = make_problem(tests::random_scene(seed, 20), {});
        const auto found = beam_lane_graph(problem, 2);
        if (!found) continue;
        ++found_some;
        const RldReport optimum = solver->solve(problem, {});
        ASSERT_EQ(optimum.status, SolveStatus::optimal);
        EXPECT_TRUE(is_feasible(problem, *found));
        const double cost = objective(problem, *found);
        EXPECT_GE(cost, *optimum.objective - 1e-9);
        if (cost > *optimum.objective + 1e-6) ++worse;
        EXPECT_EQ(beam_lane_graph(problem, 2), found);
    }
    EXPECT_GT(found_some, 20);
    EXPECT_GT(worse, 5);
}

TEST(LaneGraphBeam, HasNothingToFindWithoutCones) {
    EXPECT_FALSE(beam_lane_graph(make_problem(Scene{}, {}), 10));
}

StripProblem random_strip_problem(std::uint64_t seed, int cones) {
    return make_strip_problem(tests::random_scene(seed, cones), tests::random_strip_parameters(seed));
}

TEST(StripBeam, ThatLeavesNothingOutFindsTheOptimum) {
    StripSolver solver;
    int with_lane = 0;
    int without = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const StripProblem problem = random_strip_problem(seed, seed % 2 == 0 ? 8 : 5);
        const StripReport optimum = solver.solve(problem, {});
        const auto found = beam_strip(problem, 1'000'000);
        ASSERT_EQ(found.has_value(), optimum.status == SolveStatus::optimal);
        ++(found ? with_lane : without);
        if (!found) continue;
        EXPECT_NEAR(cheapest_strip(problem, *found).value().cost, *optimum.objective, 1e-9);
    }
    EXPECT_GT(with_lane, 20);
    EXPECT_GT(without, 3);
}

TEST(StripBeam, ThatIsNarrowMissesOptima) {
    StripSolver solver;
    int worse = 0;
    int found_some = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const StripProblem problem = random_strip_problem(seed, 16);
        const auto found = beam_strip(problem, 2);
        if (!found) continue;
        ++found_some;
        const StripReport optimum = solver.solve(problem, {});
        ASSERT_EQ(optimum.status, SolveStatus::optimal);
        const double cost = cheapest_strip(problem, *found).value().cost;
        EXPECT_GE(cost, *optimum.objective - 1e-9);
        if (cost > *optimum.objective + 1e-6) ++worse;
        EXPECT_EQ(beam_strip(problem, 2), found);
    }
    EXPECT_GT(found_some, 20);
    EXPECT_GT(worse, 5);
}

}  // namespace
}  // namespace conelane::experiments
