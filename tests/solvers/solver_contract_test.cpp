// What every exact RLD solver promises, for every solver of the registry and every formulation it uses.

#include "solvers/core_entries.hpp"
#include "solvers/milp/milp_solver.hpp"
#include "tests/support/agreement.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/learned_costs.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/solver_cases.hpp"

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

class SolverContract : public testing::TestWithParam<SolverCase> {
  protected:
    RldReport solve(const Scene& scene, const RldParameters& parameters = {}, const SolveLimits& limits = {},
                    const LaneGraph* start = nullptr) {
        const std::unique_ptr<RldSolver> solver = GetParam().entry->make(GetParam().formulation);
        return solver->solve(make_problem(scene, parameters, solver->extent()),
                             {.limits = limits, .start = start});
    }

    struct Counts {
        int lanes = 0;
        int changed = 0;  ///< lanes that are others without the extras
    };
    /// Solves scenes of 6 to 9 cones that `vary` changes; all answers must be those of every pair of paths,
    /// and confirmed by the checker.
    Counts expect_the_optimum(
        std::uint64_t seeds, const std::function<void(std::uint64_t, Scene&, RldParameters&)>& vary,
        const std::function<void(std::uint64_t, RldParameters&)>& extras = {},
        const std::function<void(const LaneGraphProblem&, const LaneGraph&)>& visit = {}) {
        Counts counts;
        for (std::uint64_t seed = 0; seed < seeds; ++seed) {
            SCOPED_TRACE(testing::Message() << "seed " << seed);
            Scene scene = tests::random_scene(seed, 6 + seed % 4);
            RldParameters parameters;
            vary(seed, scene, parameters);
            std::optional<RldReport> plain;
            if (extras) {
                plain = solve(scene, parameters);
                extras(seed, parameters);
            }
            const LaneGraphProblem problem = make_problem(scene, parameters);
            const RldReport report = solve(scene, parameters);
            if (!tests::agrees(report, make_exhaustive_solver()->solve(problem, {}))) continue;
            ++counts.lanes;
            tests::expect_confirmed(report, scene, parameters);
            if (plain && *report.lane_graph != plain->lane_graph) ++counts.changed;
            if (visit) visit(problem, *report.lane_graph);
        }
        return counts;
    }
};

/// A scene whose optimum is known; the car stands at the origin and looks along +x.
struct KnownOptimum {
    std::string why;
    std::vector<Point> cones;
    std::optional<double> objective;  ///< absent: there is no lane
    std::function<void(RldParameters&)> set = [](RldParameters&) {};
};

const std::vector<Point> kFourCones{{4, 1.5}, {7.2, 1.5}, {4, -1.5}, {7.2, -1.5}};

std::vector<Point> with(std::vector<Point> cones, const std::vector<Point>& more) {
    cones.insert(cones.end(), more.begin(), more.end());
    return cones;
}

std::vector<KnownOptimum> known_optima() {
    const std::vector<Point> one_path_near{{-1.4, 1.6},  {1.8, 1.6},   {5.0, 1.6},  {9.0, -1.6},
                                           {12.2, -1.6}, {15.4, -1.6}, {18.6, -1.6}};
    const auto lane = [](double right_ahead) {
        return std::vector<Point>{{1, 1},
                                  {4.2, 1},
                                  {7.4, 1},
                                  {1 + right_ahead, -1},
                                  {4.2 + right_ahead, -1},
                                  {7.4 + right_ahead, -1}};
    };
    std::vector<KnownOptimum> all{
        {"two straight boundaries at the expected spacing: every edge costs the benefit alone",
         {{1, 1.5}, {4.2, 1.5}, {7.4, 1.5}, {1, -1.5}, {4.2, -1.5}, {7.4, -1.5}},
         -4.0},
        {"the smallest lane", kFourCones, -2.0},
        {"all cones are near", {{1, 1.5}, {4.2, 1.5}, {1, -1.5}, {4.2, -1.5}}, {}},
        {"the far ends are too far apart", kFourCones, {}, [](RldParameters& p) { p.d_max = 2.9; }},
        {"no edge joins two cones at one place", with(kFourCones, {{7.2, -1.5}}), -2.0},
        {"the heading cost has a pole on the midpoint of an edge",
         {{0, 1.6}, {3.2, 1.6}, {6.4, 1.6}, {0, -1.6}, {3.2, -1.6}, {6.4, -1.6}},
         -4.0,
         [](RldParameters& p) { p.w_p = 1e-3; }},
        {"a far square of cones pays as a cycle, which (5) excludes",
         with(kFourCones, {{30, 10}, {33.2, 10}, {33.2, 13.2}, {30, 13.2}}), -2.0,
         [](RldParameters& p) {
             p.theta_t = 2.0;
             p.t_crit = 100.0;
             p.d_min = 0.0;
         }},
        {"one path would join both near ends", one_path_near, {}, [](RldParameters& p) { p.d_max = 16.0; }},
        {"as printed, one path may join both near ends", one_path_near, -5.0,
         [](RldParameters& p) {
             p.d_max = 16.0;
             p.pairing = Pairing::paper;
         }},
        // A lane two metres wide, less than d_min: a tie counts as between ends, so (7) lets the edges pass.
        {"edges that face exactly are between ends", lane(0.0), -4.0},
    };
    // Found by cross-check, far from the origin. The problem's tolerance of limits is 1e-9 m, a solver's
    // tolerance of rows 1e-7: the rows must decide like the problem. Both far ends are 3 m apart.
    for (const double beyond_m : {-1e-9, 0.0, 0.5e-9, 1.5e-9, 1e-8, 1e-7, 1e-6}) {
        all.push_back({"far ends " + std::to_string(1e9 * beyond_m) + " nm beyond the limit", kFourCones,
                       beyond_m < 1e-9 ? std::optional(-2.0) : std::nullopt,
                       [=](RldParameters& p) { p.d_max = 3.0 - beyond_m; }});
    }
    return all;
}

TEST_P(SolverContract, FindsKnownOptima) {
    for (const KnownOptimum& known : known_optima()) {
        SCOPED_TRACE(known.why);
        RldParameters parameters;
        known.set(parameters);
        const Scene scene = cones_at(known.cones);
        const RldReport report = solve(scene, parameters);
        ASSERT_EQ(report.status, known.objective ? SolveStatus::optimal : SolveStatus::infeasible)
            << report.message;
        if (!known.objective) continue;
        EXPECT_NEAR(*report.objective, *known.objective, 1e-9);
        tests::expect_confirmed(report, scene, parameters);
        EXPECT_TRUE(to_lane(*report.lane_graph, scene));
    }
}

TEST_P(SolverContract, AgreesWithEveryPairOfPathsOnRandomScenes) {
    const Counts counts = expect_the_optimum(200, [](std::uint64_t seed, Scene&, RldParameters& p) {
        p.pairing = seed % 2 == 0 ? Pairing::near_far : Pairing::paper;
    });
    EXPECT_GT(counts.lanes, 60);
}

/// A lane whose edges face each other in part only: moved by a quarter of the spacing, they exclude others.
TEST_P(SolverContract, EdgesThatAreTooCloseExcludeEachOther) {
    const RldReport shifted = solve(cones_at({{1, 1}, {4.2, 1}, {7.4, 1}, {1.8, -1}, {5.0, -1}, {8.2, -1}}));
    if (shifted.status == SolveStatus::optimal) {
        EXPECT_GT(*shifted.objective, -4.0 + 1e-3);
    } else {
        EXPECT_EQ(shifted.status, SolveStatus::infeasible);
    }
}

/// The left boundary continues to either of two cones at the same cost: both answers are right.
TEST_P(SolverContract, EquallyGoodLanesTie) {
    RldParameters parameters{.w_p = 0.0};
    const Scene scene =
        cones_at({{4, 1.5}, {7.2, 1.5}, {10.3, 2.3}, {10.3, 0.7}, {4, -2.5}, {7.2, -2.5}, {10.4, -2.5}});
    const double length = std::hypot(3.1, 0.8);
    const double stated = -4.0 + parameters.w_s * std::pow((length - 3.2) / 1.7, 4.0) +
                          parameters.w_t * std::pow(std::atan2(0.8, 3.1) / 0.9, 4.0);
    const RldReport report = solve(scene, parameters);
    ASSERT_EQ(report.status, SolveStatus::optimal) << report.message;
    EXPECT_NEAR(*report.objective, stated, 1e-9);
    tests::expect_confirmed(report, scene, parameters);
}

/// Extras are constraints and costs like all others.
TEST_P(SolverContract, ExtrasAgreeWithTheReferenceAndTheChecker) {
    const Counts counts = expect_the_optimum(
        60,
        [](std::uint64_t seed, Scene& scene, RldParameters& p) {
            p.d_min = 0.0;
            for (std::size_t i = 0; i < scene.cones.size(); ++i) {
                constexpr std::array kColors{ConeColor::blue, ConeColor::yellow, ConeColor::unknown,
                                             ConeColor::orange};
                scene.cones[i].color = seed % 3 == 0 ? kColors[(i * 7 + seed) % 4] : kColors[i % 2];
                scene.cones[i].confidence = 1.0 - 0.08 * static_cast<double>((i * 5 + seed) % 8);
            }
        },
        [](std::uint64_t seed, RldParameters& p) {
            p.w_color = 0.4;
            p.use_confidence = true;
            p.forbid_crossing = true;
            if (seed % 2 != 0) return;
            p.unevenness_weight = 0.3;
            p.facing_weight = 0.8;
            p.near_end_weight = 0.9;
        });
    EXPECT_GT(counts.changed, 0) << "the extras decided nothing";
}

/// Learned costs, edges over gaps and limits of nearest cones are numbers of the problem like all others:
/// every solver minimises the same costs, and the checker computes them too.
TEST_P(SolverContract, LearnedCostsAgreeWithTheReferenceAndTheChecker) {
    int over_gaps = 0;
    const Counts counts = expect_the_optimum(
        60,
        [](std::uint64_t seed, Scene&, RldParameters& p) {
            p.d_gap = 9.0;
            p.d_clear = 0.5;
            p.theta_gap = 0.6;
            p.nearest_of_edge = static_cast<double>(seed % 5);
            p.nearest_of_gap = static_cast<double>(seed % 7);
            p.d_side = seed % 3 == 0 ? 2.5 : 0.0;
        },
        [](std::uint64_t seed, RldParameters& p) {
            p.learned_costs = tests::random_learned_costs(seed, seed % 2 == 0 ? 0 : 5);
        },
        [&](const LaneGraphProblem& problem, const LaneGraph& graph) {
            over_gaps += static_cast<int>(std::ranges::count_if(problem.edges, [&](const ProblemEdge& edge) {
                return edge.gap && std::ranges::binary_search(graph.edges, Edge{edge.i, edge.j});
            }));
        });
    EXPECT_GT(counts.changed, 5) << "the learned costs decided little";
    EXPECT_GT(over_gaps, 0) << "no lane goes over a gap";
}

/// Two near edges that cross gain more than a lane without crossing; with d_min = 0 only forbid_crossing
/// excludes them.
TEST_P(SolverContract, CrossingEdgesAreForbiddenOnRequest) {
    // Edges across have the expected spacing; straight ones are too short to be allowed.
    const Scene scene = cones_at({{4, 1.0}, {6.5, 1.0}, {4, -1.0}, {6.5, -1.0}});
    RldParameters parameters{.w_p = 0.0, .d_min = 0.0, .s_crit = 1e-4};
    const RldReport crosswise = solve(scene, parameters);
    ASSERT_EQ(crosswise.status, SolveStatus::optimal) << crosswise.message;
    const LaneGraph expected{{{0, 3}, {1, 2}}};
    EXPECT_EQ(*crosswise.lane_graph, expected);
    parameters.forbid_crossing = true;
    EXPECT_EQ(solve(scene, parameters).status, SolveStatus::infeasible);
    EXPECT_THAT(check(scene, parameters, expected).violations, testing::SizeIs(1));
}

/// With any lane graph as start, the optimum is found and proven; a start that is not a lane graph of this
/// problem is dropped: other edges, none, a cone that the scene does not have, a cycle.
TEST_P(SolverContract, AStartChangesNoOptimum) {
    int started = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene_now = tests::random_scene(seed, 6 + seed % 4);
        RldParameters parameters{.pairing = seed % 4 == 3 ? Pairing::paper : Pairing::near_far};
        const RldReport cold = solve(scene_now, parameters);
        const std::vector<LaneGraph> strange{{{{0, 1}}}, {}, {{{0, 1}, {2, 30}}}, {{{0, 1}, {0, 2}, {1, 2}}}};
        const RldReport dropped = solve(scene_now, parameters, {}, &strange[seed % strange.size()]);
        if (!tests::agrees(dropped, cold)) continue;
        RldParameters other_weights = parameters;
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

/// The answer is within the gap of the bound, and the bound holds.
TEST_P(SolverContract, AGapAllowsNoMoreThanItSays) {
    constexpr double kGap = 2.0;
    for (std::uint64_t seed = 0; seed < 16; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene = tests::random_scene(seed, 6 + seed % 4);
        const RldReport best = solve(scene);
        if (!best.lane_graph) continue;
        const LaneGraph start = *solve(scene, {.w_s = 3.0, .w_p = 0.0}).lane_graph;
        for (const bool has_start : {false, true}) {
            const RldReport report = solve(scene, {}, {.absolute_gap = kGap}, has_start ? &start : nullptr);
            ASSERT_EQ(report.status, SolveStatus::optimal) << report.message;
            EXPECT_LE(*report.bound, *best.objective + 1e-6);
            EXPECT_GE(*report.bound, *report.objective - kGap - 1e-6);
        }
    }
}

/// Edges of such costs, next to which 1 is rounding; with 6 m between the boundaries, a lane has all edges.
TEST_P(SolverContract, HugeCostsAreSolvedOrRefused) {
    const std::unique_ptr<RldSolver> solver = GetParam().entry->make(GetParam().formulation);
    for (const double left_m : {1.5, 3.0}) {
        const Scene scene = cones_at({{4, left_m}, {7.2, left_m}, {4, -left_m}, {7.2, -left_m}});
        for (const double cost : {1e6, 1e13, 1e15, 4e16, 1e18, 6e19, 1e23, 1e26}) {
            LaneGraphProblem problem = make_problem(scene, {}, solver->extent());
            for (ProblemEdge& edge : problem.edges) edge.cost = cost;
            const RldReport report = solver->solve(problem, {});
            if (cost > 1e13 && report.message.find("too large") != std::string::npos) continue;
            ASSERT_EQ(report.status, SolveStatus::optimal) << cost << ": " << report.message;
            EXPECT_NEAR(*report.objective, 2.0 * cost, 1e-9 * cost);
        }
    }
}

/// With all rows from the first, one solve is enough, also where a cycle or a path between near ends pays.
TEST(AllRows, OneSolveOfOneProgramGivesTheOptimum) {
    RldParameters parameters;
    parameters.w_b = 3.0;
    parameters.w_t = 0.02;
    parameters.t_crit = 1000.0;
    parameters.d_min = 0.5;
    parameters.d_near = 8.0;
    for (const MilpBackend& backend : milp_backends()) {
        const auto load = [&](const BinaryProgram& program, std::uint64_t) { return backend.load(program); };
        const auto whole = make_milp_rld_solver(load, {.all_rows = true});
        const auto on_demand = make_milp_rld_solver(load, {});
        int rounds = 0;
        for (std::uint64_t seed = 0; seed < 12; ++seed) {
            SCOPED_TRACE(testing::Message() << backend.entry.name << ", seed " << seed);
            parameters.pairing = seed % 2 == 0 ? Pairing::near_far : Pairing::paper;
            const Scene scene = tests::random_scene(seed, 8);
            const LaneGraphProblem problem = make_problem(scene, parameters);
            const RldReport report = whole->solve(problem, {});
            EXPECT_LE(report.rounds, 1);
            rounds = std::max(rounds, on_demand->solve(problem, {}).rounds);
            if (!tests::agrees(report, make_exhaustive_solver()->solve(problem, {}))) continue;
            tests::expect_confirmed(report, scene, parameters);
        }
        EXPECT_GT(rounds, 1) << "no answer violates a row, so the test says nothing";
    }
}

INSTANTIATE_TEST_SUITE_P(Registry, SolverContract, testing::ValuesIn(exact_solver_cases()),
                         [](const auto& test) { return case_name(test.param); });

}  // namespace
}  // namespace conelane
