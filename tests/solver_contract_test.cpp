// What every exact RLD solver promises, for every solver of the registry and every formulation it uses.

#include "model/check.hpp"
#include "model/lane_graph_problem.hpp"
#include "solvers/exhaustive.hpp"
#include "solvers/registry.hpp"
#include "tests/random_scenes.hpp"

#include <algorithm>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace conelane {
namespace {

struct Contestant {
    const RldSolverEntry* entry;
    Formulation formulation;
    friend void PrintTo(const Contestant& c, std::ostream* out) {
        *out << c.entry->name << to_string(c.formulation);
    }
};

std::vector<Contestant> contestants() {
    std::vector<Contestant> all;
    for (const RldSolverEntry& entry : rld_solvers()) {
        if (!entry.exact) continue;  // see relaxation_test
        all.push_back({&entry, Formulation::tight});
        if (entry.uses_formulation) all.push_back({&entry, Formulation::paper});
    }
    return all;
}

Scene scene_of(const std::vector<Point>& positions) {
    Scene scene;
    for (const Point& position : positions) {
        scene.cones.push_back({static_cast<ConeId>(scene.cones.size()), position});
    }
    return scene;
}

/// Edges as cone indices; the car stands at the origin and looks along +x.
class SolverContract : public testing::TestWithParam<Contestant> {
  protected:
    RldReport solve(const Scene& scene, const RldParameters& parameters = {},
                    const SolveLimits& limits = {}) {
        const std::unique_ptr<RldSolver> solver = GetParam().entry->make(GetParam().formulation);
        return solver->solve(make_problem(scene, parameters, solver->extent()), limits);
    }
};

/// Two straight boundaries at the expected spacing: every edge costs the benefit less its heading cost of
/// zero, every angle is pi, so four edges cost -4.
TEST_P(SolverContract, StraightLane) {
    const Scene scene = scene_of({{1, 1.5}, {4.2, 1.5}, {7.4, 1.5}, {1, -1.5}, {4.2, -1.5}, {7.4, -1.5}});
    const RldReport report = solve(scene);
    ASSERT_EQ(report.status, SolveStatus::optimal) << report.message;
    EXPECT_NEAR(*report.objective, -4.0, 1e-9);
    EXPECT_NEAR(*report.bound, -4.0, 1e-6);
    const LaneGraph expected{{{0, 1}, {1, 2}, {3, 4}, {4, 5}}};
    EXPECT_EQ(*report.lane_graph, expected);
    const Lane lane{{0, 1, 2}, {3, 4, 5}};
    EXPECT_EQ(to_lane(*report.lane_graph, scene), lane);
}

TEST_P(SolverContract, FourConesAreTheSmallestLane) {
    const RldReport report = solve(scene_of({{4, 1.5}, {7.2, 1.5}, {4, -1.5}, {7.2, -1.5}}));
    ASSERT_EQ(report.status, SolveStatus::optimal) << report.message;
    EXPECT_NEAR(*report.objective, -2.0, 1e-9);
}

TEST_P(SolverContract, FewerThanFourConesAreInfeasible) {
    EXPECT_EQ(solve(scene_of({})).status, SolveStatus::infeasible);
    EXPECT_EQ(solve(scene_of({{4, 1.5}})).status, SolveStatus::infeasible);
    EXPECT_EQ(solve(scene_of({{4, 1.5}, {7.2, 1.5}, {4, -1.5}})).status, SolveStatus::infeasible);
}

TEST_P(SolverContract, AllConesNearAreInfeasible) {
    EXPECT_EQ(solve(scene_of({{1, 1.5}, {4.2, 1.5}, {1, -1.5}, {4.2, -1.5}})).status,
              SolveStatus::infeasible);
}

TEST_P(SolverContract, FarEndsMoreThanTheLimitApartAreInfeasible) {
    RldParameters parameters;
    parameters.d_max = 2.9;
    EXPECT_EQ(solve(scene_of({{4, 1.5}, {7.2, 1.5}, {4, -1.5}, {7.2, -1.5}}), parameters).status,
              SolveStatus::infeasible);
}

/// Two cones at one place: no edge joins them, and one of them is left out.
TEST_P(SolverContract, CoincidentCones) {
    const RldReport report = solve(scene_of({{4, 1.5}, {7.2, 1.5}, {4, -1.5}, {7.2, -1.5}, {7.2, -1.5}}));
    ASSERT_EQ(report.status, SolveStatus::optimal) << report.message;
    EXPECT_NEAR(*report.objective, -2.0, 1e-9);
    EXPECT_EQ(report.lane_graph->edges.size(), 2u);
}

/// The car stands on the midpoint of an edge across its way: the heading cost has its pole there and stays
/// finite.
TEST_P(SolverContract, CarOnAMidpoint) {
    RldParameters parameters;
    parameters.w_p = 1e-3;
    const Scene scene = scene_of({{0, 1.6}, {3.2, 1.6}, {6.4, 1.6}, {0, -1.6}, {3.2, -1.6}, {6.4, -1.6}});
    const RldReport report = solve(scene, parameters);
    ASSERT_EQ(report.status, SolveStatus::optimal) << report.message;
    EXPECT_TRUE(check(scene, parameters, *report.lane_graph).violations.empty());
}

/// A far, regular square of cones pays as a cycle; rows (1)-(4) allow it beside the two paths, (5) does not.
TEST_P(SolverContract, APayingCycleIsExcluded) {
    RldParameters parameters;
    parameters.theta_t = 2.0;
    parameters.t_crit = 100.0;
    parameters.d_min = 0.0;
    const Scene scene = scene_of(
        {{4, 1.5}, {7.2, 1.5}, {4, -1.5}, {7.2, -1.5}, {30, 10}, {33.2, 10}, {33.2, 13.2}, {30, 13.2}});
    const RldReport report = solve(scene, parameters);
    ASSERT_EQ(report.status, SolveStatus::optimal) << report.message;
    EXPECT_TRUE(check(scene, parameters, *report.lane_graph).violations.empty());
    EXPECT_NEAR(*report.objective, -2.0, 1e-9);
}

/// Three near cones in a row and four far ones: as printed, the one path joins both near endpoints and the
/// other both far ones. Pairing near_far finds no lane here.
TEST_P(SolverContract, PairingDecidesOnANearNearPath) {
    const Scene scene = scene_of(
        {{-1.4, 1.6}, {1.8, 1.6}, {5.0, 1.6}, {9.0, -1.6}, {12.2, -1.6}, {15.4, -1.6}, {18.6, -1.6}});
    RldParameters parameters;
    parameters.d_max = 16.0;
    EXPECT_EQ(solve(scene, parameters).status, SolveStatus::infeasible);
    parameters.pairing = Pairing::paper;
    const RldReport printed = solve(scene, parameters);
    ASSERT_EQ(printed.status, SolveStatus::optimal) << printed.message;
    EXPECT_NEAR(*printed.objective, -5.0, 1e-9);
}

TEST_P(SolverContract, AgreesWithEveryPairOfPathsOnRandomScenes) {
    int feasible = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene = tests::random_scene(seed, 6 + seed % 4);
        RldParameters parameters;
        parameters.pairing = seed % 2 == 0 ? Pairing::near_far : Pairing::paper;
        const RldReport reference = make_exhaustive_solver()->solve(make_problem(scene, parameters), {});
        const RldReport report = solve(scene, parameters);
        ASSERT_EQ(report.status, reference.status) << report.message;
        if (reference.status != SolveStatus::optimal) continue;
        ++feasible;
        EXPECT_NEAR(*report.objective, *reference.objective, 1e-6);
        const CheckReport verdict =
            check(scene, parameters, *report.lane_graph, {true, *report.objective, report.bound});
        EXPECT_THAT(verdict.violations, testing::IsEmpty());
    }
    EXPECT_GT(feasible, 60);
}

/// The optimum as start stays the optimum, with proof; so does any other lane graph; one that is none for
/// this problem is dropped.
TEST_P(SolverContract, AStartChangesNoOptimum) {
    int started = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene_now = tests::random_scene(seed, 6 + seed % 4);
        const RldParameters parameters;
        const RldReport cold = solve(scene_now, parameters);
        LaneGraph strange{{{0, 1}}};
        const RldReport dropped = solve(scene_now, parameters, {.start = &strange});
        ASSERT_EQ(dropped.status, cold.status);
        if (cold.status != SolveStatus::optimal) continue;
        EXPECT_NEAR(*dropped.objective, *cold.objective, 1e-6);
        RldParameters other_weights;
        other_weights.w_p = 0.0;
        other_weights.w_s = 3.0;
        const LaneGraph other = *solve(scene_now, other_weights).lane_graph;
        for (const LaneGraph& start : {*cold.lane_graph, other}) {
            ++started;
            const RldReport warm = solve(scene_now, parameters, {.start = &start});
            ASSERT_EQ(warm.status, SolveStatus::optimal) << warm.message;
            EXPECT_NEAR(*warm.objective, *cold.objective, 1e-6);
            EXPECT_THAT(check(scene_now, parameters, *warm.lane_graph, {true, *warm.objective, warm.bound})
                            .violations,
                        testing::IsEmpty());
        }
    }
    EXPECT_GT(started, 20);
}

INSTANTIATE_TEST_SUITE_P(Registry, SolverContract, testing::ValuesIn(contestants()), [](const auto& test) {
    std::string name =
        std::string(test.param.entry->name) + "_" + std::string(to_string(test.param.formulation));
    std::ranges::replace(name, '-', '_');
    return name;
});

}  // namespace
}  // namespace conelane
