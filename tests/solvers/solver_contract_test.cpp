// What every exact RLD solver promises, for every solver of the registry and every formulation it uses.

#include "conelane/check.hpp"
#include "conelane/lane_graph_problem.hpp"
#include "solvers/core_entries.hpp"
#include "solvers/registry.hpp"
#include "tests/support/agreement.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/learned_costs.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/solver_cases.hpp"
#include "tests/support/testing.hpp"

#include <ostream>

namespace conelane {
namespace {

using tests::cones_at;
using tests::SolverCase;

/// The solvers that prove their optimum. Requirements of all solvers are in solver_robustness_test.
std::vector<SolverCase> exact_solver_cases() {
    std::vector<SolverCase> all = tests::solver_cases();
    std::erase_if(all, [](const SolverCase& solver) { return !solver.entry->has(SolverTrait::exact); });
    return all;
}

/// Edges as cone indices; the car stands at the origin and looks along +x.
class SolverContract : public testing::TestWithParam<SolverCase> {
  protected:
    RldReport solve(const Scene& scene, const RldParameters& parameters = {}, const SolveLimits& limits = {},
                    const LaneGraph* start = nullptr) {
        const std::unique_ptr<RldSolver> solver = GetParam().entry->make(GetParam().formulation);
        return solver->solve(make_problem(scene, parameters, solver->extent()),
                             {.limits = limits, .start = start});
    }
};

/// Two straight boundaries at the expected spacing: every edge costs the benefit less its heading cost of
/// zero, every angle is pi, so four edges cost -4.
TEST_P(SolverContract, StraightLane) {
    const Scene scene = cones_at({{1, 1.5}, {4.2, 1.5}, {7.4, 1.5}, {1, -1.5}, {4.2, -1.5}, {7.4, -1.5}});
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
    const RldReport report = solve(cones_at({{4, 1.5}, {7.2, 1.5}, {4, -1.5}, {7.2, -1.5}}));
    ASSERT_EQ(report.status, SolveStatus::optimal) << report.message;
    EXPECT_NEAR(*report.objective, -2.0, 1e-9);
}

TEST_P(SolverContract, FewerThanFourConesAreInfeasible) {
    EXPECT_EQ(solve(cones_at({})).status, SolveStatus::infeasible);
    EXPECT_EQ(solve(cones_at({{4, 1.5}})).status, SolveStatus::infeasible);
    EXPECT_EQ(solve(cones_at({{4, 1.5}, {7.2, 1.5}, {4, -1.5}})).status, SolveStatus::infeasible);
}

TEST_P(SolverContract, AllConesNearAreInfeasible) {
    EXPECT_EQ(solve(cones_at({{1, 1.5}, {4.2, 1.5}, {1, -1.5}, {4.2, -1.5}})).status,
              SolveStatus::infeasible);
}

TEST_P(SolverContract, FarEndsMoreThanTheLimitApartAreInfeasible) {
    RldParameters parameters;
    parameters.d_max = 2.9;
    EXPECT_EQ(solve(cones_at({{4, 1.5}, {7.2, 1.5}, {4, -1.5}, {7.2, -1.5}}), parameters).status,
              SolveStatus::infeasible);
}

/// Found by cross-check, far from the origin. The problem's tolerance of limits is 1e-9 m, a solver's
/// tolerance of rows 1e-7: the rows must decide like the problem. Both far ends are 3 m apart.
TEST_P(SolverContract, FarEndsThatNearlyTieWithTheLimit) {
    for (const double beyond_m : {-1e-9, 0.0, 0.5e-9, 1.5e-9, 1e-8, 1e-7, 1e-6}) {
        SCOPED_TRACE(beyond_m);
        RldParameters parameters;
        parameters.d_max = 3.0 - beyond_m;
        const RldReport report = solve(cones_at({{4, 1.5}, {7.2, 1.5}, {4, -1.5}, {7.2, -1.5}}), parameters);
        EXPECT_EQ(report.status, beyond_m < 1e-9 ? SolveStatus::optimal : SolveStatus::infeasible)
            << report.message;
    }
}

/// Two cones at one place: no edge joins them, and one is left out.
TEST_P(SolverContract, CoincidentCones) {
    const RldReport report = solve(cones_at({{4, 1.5}, {7.2, 1.5}, {4, -1.5}, {7.2, -1.5}, {7.2, -1.5}}));
    ASSERT_EQ(report.status, SolveStatus::optimal) << report.message;
    EXPECT_NEAR(*report.objective, -2.0, 1e-9);
    EXPECT_EQ(report.lane_graph->edges.size(), 2u);
}

/// The car is on the midpoint of an edge across its way: the heading cost has its pole there and must be
/// finite.
TEST_P(SolverContract, CarOnAMidpoint) {
    RldParameters parameters;
    parameters.w_p = 1e-3;
    const Scene scene = cones_at({{0, 1.6}, {3.2, 1.6}, {6.4, 1.6}, {0, -1.6}, {3.2, -1.6}, {6.4, -1.6}});
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
    const Scene scene = cones_at(
        {{4, 1.5}, {7.2, 1.5}, {4, -1.5}, {7.2, -1.5}, {30, 10}, {33.2, 10}, {33.2, 13.2}, {30, 13.2}});
    const RldReport report = solve(scene, parameters);
    ASSERT_EQ(report.status, SolveStatus::optimal) << report.message;
    EXPECT_TRUE(check(scene, parameters, *report.lane_graph).violations.empty());
    EXPECT_NEAR(*report.objective, -2.0, 1e-9);
}

/// Three near cones in a row and four far ones: as printed, the one path joins both near endpoints and the
/// other both far ones. Pairing near_far finds no lane here.
TEST_P(SolverContract, PairingDecidesOnANearNearPath) {
    const Scene scene = cones_at(
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
        if (!tests::agrees(report, reference)) continue;
        ++feasible;
        tests::expect_confirmed(report, scene, parameters);
    }
    EXPECT_GT(feasible, 60);
}

/// A lane two metres wide, less than d_min. Exactly facing edges tie between ends and interior points, which
/// counts as between ends, so (7) lets them pass; moved by a quarter of the spacing they exclude each other.
TEST_P(SolverContract, ExactlyFacingEdgesAreBetweenEnds) {
    const auto lane = [](double shift) {
        return cones_at({{1, 1}, {4.2, 1}, {7.4, 1}, {1 + shift, -1}, {4.2 + shift, -1}, {7.4 + shift, -1}});
    };
    const RldReport facing = solve(lane(0.0));
    ASSERT_EQ(facing.status, SolveStatus::optimal) << facing.message;
    EXPECT_NEAR(*facing.objective, -4.0, 1e-9);
    const RldReport shifted = solve(lane(0.8));
    if (shifted.status == SolveStatus::optimal) {
        EXPECT_GT(*shifted.objective, -4.0 + 1e-3);
    } else {
        EXPECT_EQ(shifted.status, SolveStatus::infeasible);
    }
}

/// The left boundary continues to either of two cones at the same cost: both answers are right.
TEST_P(SolverContract, EquallyGoodLanesTie) {
    RldParameters parameters;
    parameters.w_p = 0.0;
    const Scene scene =
        cones_at({{4, 1.5}, {7.2, 1.5}, {10.3, 2.3}, {10.3, 0.7}, {4, -2.5}, {7.2, -2.5}, {10.4, -2.5}});
    const double length = std::hypot(3.1, 0.8);
    const double stated = -4.0 + parameters.w_s * std::pow((length - 3.2) / 1.7, 4.0) +
                          parameters.w_t * std::pow(std::atan2(0.8, 3.1) / 0.9, 4.0);
    const RldReport report = solve(scene, parameters);
    ASSERT_EQ(report.status, SolveStatus::optimal) << report.message;
    EXPECT_NEAR(*report.objective, stated, 1e-9);
    EXPECT_THAT(
        check(scene, parameters, *report.lane_graph, {true, *report.objective, report.bound}).violations,
        testing::IsEmpty());
}

/// With however little time, a claim is true: no wrong optimum, a valid bound, a lane graph that is
/// one.
TEST_P(SolverContract, ATimeLimitNeverMakesAClaimWrong) {
    const std::size_t cones =
        GetParam().entry->has(SolverTrait::uses_formulation) ? 14 : kExhaustiveMostCones;
    const auto reference_solver = find_rld_solver("cbc")->make(Formulation::tight);
    int stopped = 0;
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        const Scene scene = tests::random_scene(seed, cones);
        const RldParameters parameters;
        const RldReport reference = reference_solver->solve(make_problem(scene, parameters), {});
        for (const double time_limit_ms : {1e-6, 0.3, 1.0, 4.0, 15.0}) {
            SCOPED_TRACE(testing::Message() << "seed " << seed << ", limit " << time_limit_ms << " ms");
            const RldReport report = solve(scene, parameters, {time_limit_ms});
            if (report.bound && reference.objective) {
                EXPECT_LE(*report.bound, *reference.objective + 1e-6);
            }
            switch (report.status) {
                case SolveStatus::optimal:
                    EXPECT_NEAR(*report.objective, *reference.objective, 1e-6);
                    break;
                case SolveStatus::feasible:
                    ++stopped;
                    EXPECT_THAT(
                        check(scene, parameters, *report.lane_graph, {false, *report.objective, report.bound})
                            .violations,
                        testing::IsEmpty());
                    break;
                case SolveStatus::stopped:
                    ++stopped;
                    EXPECT_FALSE(report.lane_graph.has_value());
                    break;
                case SolveStatus::infeasible:
                    EXPECT_EQ(reference.status, SolveStatus::infeasible);
                    break;
                case SolveStatus::error:
                    ADD_FAILURE() << report.message;
            }
        }
    }
    EXPECT_GE(stopped, 6) << "the shortest limit stops every scene";
}

/// Extras are constraints and costs like all others.
TEST_P(SolverContract, ExtrasAgreeWithTheReferenceAndTheChecker) {
    int changed = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Scene scene = tests::random_scene(seed, 6 + seed % 4);
        for (std::size_t i = 0; i < scene.cones.size(); ++i) {
            constexpr std::array kColors{ConeColor::blue, ConeColor::yellow, ConeColor::unknown,
                                         ConeColor::orange};
            scene.cones[i].color = seed % 3 == 0 ? kColors[(i * 7 + seed) % 4] : kColors[i % 2];
            scene.cones[i].confidence = 1.0 - 0.08 * static_cast<double>((i * 5 + seed) % 8);
        }
        RldParameters parameters;
        parameters.d_min = 0.0;
        const RldReport plain = solve(scene, parameters);
        parameters.w_color = 0.4;
        parameters.use_confidence = true;
        parameters.forbid_crossing = true;
        if (seed % 2 == 0) {
            parameters.unevenness_weight = 0.3;
            parameters.facing_weight = 0.8;
            parameters.near_end_weight = 0.9;
        }
        const RldReport reference = make_exhaustive_solver()->solve(make_problem(scene, parameters), {});
        const RldReport report = solve(scene, parameters);
        if (!tests::agrees(report, reference)) continue;
        tests::expect_confirmed(report, scene, parameters);
        if (*report.lane_graph != *plain.lane_graph) ++changed;
    }
    EXPECT_GT(changed, 0) << "the extras decided nothing";
}

/// Learned costs, edges over gaps and limits of nearest cones are numbers of the problem like all others:
/// every solver minimises the same costs, and the checker computes them too.
TEST_P(SolverContract, LearnedCostsAgreeWithTheReferenceAndTheChecker) {
    int changed = 0;
    int over_gaps = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene = tests::random_scene(seed, 6 + seed % 4);
        RldParameters parameters;
        parameters.d_gap = 9.0;
        parameters.d_clear = 0.5;
        parameters.theta_gap = 0.6;
        parameters.nearest_of_edge = static_cast<double>(seed % 5);
        parameters.nearest_of_gap = static_cast<double>(seed % 7);
        parameters.d_side = seed % 3 == 0 ? 2.5 : 0.0;
        const RldReport plain = solve(scene, parameters);
        parameters.learned_costs = tests::random_learned_costs(seed, seed % 2 == 0 ? 0 : 5);
        const LaneGraphProblem problem = make_problem(scene, parameters);
        const RldReport reference = make_exhaustive_solver()->solve(problem, {});
        const RldReport report = solve(scene, parameters);
        if (!tests::agrees(report, reference)) continue;
        tests::expect_confirmed(report, scene, parameters);
        if (*report.lane_graph != *plain.lane_graph) ++changed;
        for (const ProblemEdge& edge : problem.edges) {
            if (edge.gap && std::ranges::binary_search(report.lane_graph->edges, Edge{edge.i, edge.j}))
                ++over_gaps;
        }
    }
    EXPECT_GT(changed, 5) << "the learned costs decided little";
    EXPECT_GT(over_gaps, 0) << "no lane goes over a gap";
}

/// Two near edges that cross gain more than a lane without crossing; with d_min = 0 only forbid_crossing
/// excludes them.
TEST_P(SolverContract, CrossingEdgesAreForbiddenOnRequest) {
    // Edges across have the expected spacing; straight ones are too short to be allowed.
    const Scene scene = cones_at({{4, 1.0}, {6.5, 1.0}, {4, -1.0}, {6.5, -1.0}});
    RldParameters parameters;
    parameters.d_min = 0.0;
    parameters.s_crit = 1e-4;
    parameters.w_p = 0.0;
    const RldReport crosswise = solve(scene, parameters);
    ASSERT_EQ(crosswise.status, SolveStatus::optimal) << crosswise.message;
    const LaneGraph expected{{{0, 3}, {1, 2}}};
    EXPECT_EQ(*crosswise.lane_graph, expected);
    parameters.forbid_crossing = true;
    EXPECT_EQ(solve(scene, parameters).status, SolveStatus::infeasible);
    EXPECT_THAT(check(scene, parameters, expected).violations, testing::SizeIs(1));
}

/// With any lane graph as start, the optimum is found and proven; a start that is not a lane graph of this
/// problem is dropped.
TEST_P(SolverContract, AStartChangesNoOptimum) {
    int started = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene_now = tests::random_scene(seed, 6 + seed % 4);
        const RldParameters parameters;
        const RldReport cold = solve(scene_now, parameters);
        LaneGraph strange{{{0, 1}}};
        const RldReport dropped = solve(scene_now, parameters, {}, &strange);
        if (!tests::agrees(dropped, cold)) continue;
        RldParameters other_weights;
        other_weights.w_p = 0.0;
        other_weights.w_s = 3.0;
        const LaneGraph other = *solve(scene_now, other_weights).lane_graph;
        for (const LaneGraph& start : {*cold.lane_graph, other}) {
            ++started;
            const RldReport warm = solve(scene_now, parameters, {}, &start);
            EXPECT_TRUE(tests::agrees(warm, cold));
            tests::expect_confirmed(warm, scene_now, parameters);
        }
    }
    EXPECT_GT(started, 20);
}

INSTANTIATE_TEST_SUITE_P(Registry, SolverContract, testing::ValuesIn(exact_solver_cases()),
                         [](const auto& test) { return case_name(test.param); });

}  // namespace
}  // namespace conelane
