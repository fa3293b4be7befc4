// The checker's own search against the exact solvers, and verdicts on claims of optima and of infeasibility.

#include "evaluation/proofs/lane_graph_search.hpp"

#include "conelane/check.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/proofs/answer_check.hpp"
#include "solvers/core_entries.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/straight_scene.hpp"

namespace conelane {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// Some of these scenes have a lane graph, some have none.
void expect_agreement(RldSolver& solver, const RldParameters& parameters, std::size_t cones) {
    int with_lane = 0;
    constexpr int kScenes = 60;
    for (int seed = 0; seed < kScenes; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene = tests::random_scene(static_cast<std::uint64_t>(seed), cones);
        const LaneGraphSearchResult result = search_lane_graph(scene, parameters, kNoLimit);
        EXPECT_TRUE(result.complete);
        const RldReport report = solver.solve(make_problem(scene, parameters, solver.extent()), {});
        EXPECT_EQ(result.witness.has_value(), report.lane_graph.has_value());
        if (!result.witness) continue;
        ++with_lane;
        EXPECT_TRUE(check(scene, parameters, *result.witness).violations.empty());
    }
    EXPECT_GT(with_lane, kScenes / 10);
    EXPECT_LT(with_lane, kScenes);
}

TEST(LaneGraphSearch, AgreesWithEveryPairOfPaths) {
    RldParameters parameters;
    expect_agreement(*make_exhaustive_solver(), parameters, 7);
    parameters.pairing = Pairing::paper;
    expect_agreement(*make_exhaustive_solver(), parameters, 7);
    parameters.forbid_crossing = true;
    parameters.d_max = 4.0;
    expect_agreement(*make_exhaustive_solver(), parameters, 7);
}

TEST(LaneGraphSearch, AgreesWithThePairSearch) {
    expect_agreement(*make_path_pair_solver(), {}, 12);
}

/// One path joins the near cones 2 and 3, the other one the far cones 0 and 1, which come first:
///     2 ----- 3
/// car >                        0 ----- 1
TEST(LaneGraphSearch, WithThePairingOfThePaperAPathOfFarConesMayComeFirst) {
    Scene scene = tests::cones_at({{11.0, -1.75}, {14.2, -1.75}, {1.0, 1.75}, {4.2, 1.75}});
    RldParameters parameters;
    parameters.d_h = 20.0;  // so all edges are along the heading
    EXPECT_FALSE(search_lane_graph(scene, parameters, kNoLimit).witness);
    parameters.pairing = Pairing::paper;
    const LaneGraphSearchResult result = search_lane_graph(scene, parameters, kNoLimit);
    ASSERT_TRUE(result.witness);
    EXPECT_EQ(result.witness->edges, (std::vector<Edge>{{0, 1}, {2, 3}}));
}

TEST(LaneGraphSearch, ReportsThatTheTimeRanOut) {
    const LaneGraphSearchResult result = search_lane_graph(tests::random_scene(3, 60), {}, 0.0);
    EXPECT_FALSE(result.complete);
    EXPECT_FALSE(result.witness);

    // So few edges that the time ends only among the paths. None of them ends at a far cone.
    Scene grid;
    for (int i = 0; i < 16; ++i) grid.cones.push_back({i, {3.2 * (i / 4), 3.2 * (i % 4)}});
    RldParameters parameters{.d_h = 100.0, .d_near = 100.0};
    parameters.s_crit = 0.1;  // allows no diagonals, but turns by a right angle
    parameters.t_crit = 10.0;
    EXPECT_TRUE(search_lane_graph(grid, parameters, kNoLimit).complete);
    const LaneGraphSearchResult stopped = search_lane_graph(grid, parameters, 0.0);
    EXPECT_FALSE(stopped.complete);
    EXPECT_FALSE(stopped.witness);
}

constexpr double kNone = std::numeric_limits<double>::infinity();  ///< the claim that there is no lane graph

/// The near endpoints are in the lane only.
TEST(Infeasibility, IsJudgedWithoutTheClaimant) {
    using Kind = ClaimVerdict::Kind;
    const Scene straight = straight_scene().scene;
    for (const char* claimant : {"cbc", "path-pair", "exhaustive"}) {
        const ClaimVerdict wrong = judge_bound(straight, {}, kNone, claimant, kNoLimit);
        EXPECT_EQ(wrong.kind, Kind::wrong);
        EXPECT_NE(wrong.by, claimant);
        ASSERT_TRUE(wrong.witness);
        EXPECT_TRUE(check(straight, {}, *wrong.witness).violations.empty());
        Scene passed = straight;
        passed.pose.position.x() = 200.0;
        EXPECT_EQ(judge_bound(passed, {}, kNone, claimant, kNoLimit).kind, Kind::proven);
    }
    EXPECT_EQ(judge_bound(straight, {}, kNone, "cbc", 0.0).kind, Kind::unverified);
}

/// Without time, neither the checker's search nor multipliers decide, so another solver is asked.
TEST(Infeasibility, AsksAnotherSolverThanTheClaimant) {
    const Scene scene = tests::random_scene(3, 60);
    EXPECT_EQ(judge_bound(scene, {}, kNone, "cbc", 0.0).by, "path-pair");
    const std::string other = judge_bound(scene, {}, kNone, "path-pair", 0.0).by;
    EXPECT_NE(other, "path-pair");
    EXPECT_NE(other, "");
}

/// Claims about the optimum of random scenes: the true one, one too low, and one that no lane graph has.
TEST(Optimality, IsProvenOrRefuted) {
    using Kind = ClaimVerdict::Kind;
    int feasible = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Scene scene = tests::random_scene(seed, 14);
        RldParameters parameters{.pairing = seed % 2 == 0 ? Pairing::near_far : Pairing::paper};
        const auto solver = make_path_pair_solver();
        const RldReport exact = solve_scene(*solver, scene, parameters, {}).report;
        if (exact.status != SolveStatus::optimal) continue;
        ++feasible;
        for (const char* const claimant : {"cbc", "path-pair", "stranger"}) {
            SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << claimant);
            const auto judged = [&](double bound) {
                return judge_bound(scene, parameters, bound, claimant, kNoLimit);
            };
            EXPECT_EQ(judged(*exact.objective).kind, Kind::proven);
            EXPECT_EQ(judged(*exact.objective - 0.1).kind, Kind::proven) << "a bound below it holds too";
            const ClaimVerdict wrong = judged(*exact.objective + 0.1);
            EXPECT_EQ(wrong.kind, Kind::wrong);
            EXPECT_NEAR(wrong.objective.value(), *exact.objective, 1e-6);
        }
    }
    EXPECT_GT(feasible, 5);
    EXPECT_EQ(judge_bound(tests::random_scene(3, 60), {}, 0.0, "cbc", 0.0).kind, Kind::unverified);
}

}  // namespace
}  // namespace conelane
