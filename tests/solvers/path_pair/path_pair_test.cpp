// path-pair as a whole: the optima of other solvers, and true answers for any deadline and mode.

#include "solvers/core_entries.hpp"
#include "solvers/milp/milp_solver.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "solvers/path_pair/search/branch_and_bound.hpp"
#include "tests/support/agreement.hpp"
#include "tests/support/clocks/fake_search_clock.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/learned_costs.hpp"
#include "tests/support/near_to_far.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/six_cone_lane.hpp"

namespace conelane::path_pair {
namespace {

RldReport solve(RldSolver& solver, const Scene& scene, const RldParameters& parameters,
                double time_limit_ms = std::numeric_limits<double>::infinity()) {
    return solver.solve(make_problem(scene, parameters), {.limits = {time_limit_ms, 1e-9}});
}

/// One instance over many scenes of different sizes, with either default of d_max and either pairing.
TEST(PathPair, AgreesWithCbc) {
    const std::unique_ptr<RldSolver> path_pair = make_path_pair_solver();
    const std::unique_ptr<RldSolver> cbc = kCbc.entry.make(Formulation::tight);
    int feasible = 0;
    for (std::uint64_t seed = 0; seed < 120; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene = tests::random_scene(1000 + seed, 6 + seed % 13);
        RldParameters parameters;
        if (seed % 2 == 0) parameters.d_max = 16.0;
        if (seed % 3 == 0) parameters.pairing = Pairing::paper;
        const RldReport expected = solve(*cbc, scene, parameters);
        const RldReport report = solve(*path_pair, scene, parameters);
        if (!tests::agrees(report, expected)) continue;
        ++feasible;
        tests::expect_confirmed(report, scene, parameters);
    }
    EXPECT_GT(feasible, 60);
}

/// Cycles that gain about as much as counts as rounding, or to which a small raise is rounding.
TEST(PathPair, EndsWhateverTheSizeOfCosts) {
    const RldParameters parameters{.d_min = 1.0, .d_max = 16.0, .s_crit = 100.0, .t_crit = 100.0};
    PathPairOptions options;
    options.max_work = 100'000'000;
    const std::unique_ptr<RldSolver> solver = make_path_pair_solver(options);
    for (const double cost : {1e-12, 3e-12, 1e-3, 1e9, 1e16}) {
        for (std::uint64_t seed = 0; seed < 20; ++seed) {
            LaneGraphProblem problem = make_problem(tests::random_scene(seed, 9), parameters);
            for (ProblemEdge& edge : problem.edges) edge.cost = -cost;
            for (ProblemTurn& turn : problem.turns) turn.cost = seed % 2 == 0 ? cost / 3.0 : 0.0;
            EXPECT_EQ(solver->solve(problem, {}).status, SolveStatus::optimal) << cost << ", seed " << seed;
        }
    }
}

TEST(PathPair, EveryStageCanBeSwitchedOff) {
    const std::unique_ptr<RldSolver> complete = make_path_pair_solver();
    std::vector<PathPairOptions> ablations(7);
    ablations[0].fix_arcs = false;
    ablations[1].clique_multipliers = false;
    ablations[2].complete_walks = false;
    ablations[3].search_frontiers = false;
    ablations[4].root_steps = 1;
    ablations[4].node_steps = 1;
    ablations[5].drop_dominated_edges = false;
    ablations[6].search_windows = false;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene = tests::random_scene(seed, 12);
        const RldReport expected = solve(*complete, scene, {});
        for (const PathPairOptions& options : ablations)
            (void)tests::agrees(solve(*make_path_pair_solver(options), scene, {}), expected);
    }
}

/// Without the frontiers, and with the smoothed ascent at the first step, on strewn cones that are dense.
TEST(PathPair, AgreesWithCbcAfterASmoothedAscent) {
    PathPairOptions options{.search_frontiers = false};
    options.tuning.ascent.smoothed_step = 0;
    const std::unique_ptr<RldSolver> path_pair = make_path_pair_solver(options);
    const std::unique_ptr<RldSolver> cbc = kCbc.entry.make(Formulation::tight);
    int feasible = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene = tests::strewn_scene(8 + seed % 7, 12.0, 8.0, seed);
        RldParameters parameters;
        if (seed % 3 == 0) parameters.pairing = Pairing::paper;
        if (tests::agrees(solve(*path_pair, scene, parameters), solve(*cbc, scene, parameters))) ++feasible;
    }
    EXPECT_GT(feasible, 20);
}

/// The optimum as a start is kept, another lane graph is improved, an invalid one is dropped.
TEST(PathPair, StartsFromALaneGraph) {
    const std::unique_ptr<RldSolver> solver = make_path_pair_solver();
    int started = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const LaneGraphProblem problem = make_problem(tests::random_scene(seed, 16), {});
        const RldReport cold = solver->solve(problem, {});
        if (!cold.lane_graph) continue;
        ++started;
        const LaneGraph& optimum = *cold.lane_graph;
        EXPECT_EQ(solver->solve(problem, {.start = &optimum}).lane_graph, cold.lane_graph);
        const RldReport stopped =
            solver->solve(problem, {.limits = {.time_limit_ms = 0.0}, .start = &optimum});
        EXPECT_EQ(stopped.status, SolveStatus::feasible);
        EXPECT_EQ(stopped.objective, cold.objective);
        EXPECT_EQ(stopped.stopped_by, StopReason::time);
        LaneGraph torn = optimum;
        torn.edges.erase(torn.edges.begin() + static_cast<std::ptrdiff_t>(torn.edges.size() / 2));
        EXPECT_NEAR(*solver->solve(problem, {.start = &torn}).objective, *cold.objective, 1e-9);
    }
    EXPECT_GT(started, 20);
}

/// With a gap above any difference of costs, every lane graph is good enough, so the start is the answer.
/// Without a start, any lane graph is.
TEST(PathPair, AWideGapTakesTheStartButProvesNothingWrong) {
    Scene scene = tests::six_cone_lane();
    scene.cones.push_back({6, {10.6, 1.75}});  // the best lane goes on to it
    const LaneGraphProblem problem = make_problem(scene, {});
    const std::unique_ptr<RldSolver> solver = make_path_pair_solver();
    const LaneGraph start{{{0, 1}, {1, 2}, {2, 6}, {3, 4}, {4, 5}}};
    for (const double gap : {100.0, 1e6, std::numeric_limits<double>::infinity()}) {
        SCOPED_TRACE(testing::Message() << "gap " << gap);
        const RldReport warm = solver->solve(problem, {.limits = {.absolute_gap = gap}, .start = &start});
        EXPECT_EQ(warm.status, SolveStatus::optimal);
        EXPECT_EQ(warm.lane_graph, start);
        const RldReport cold = solver->solve(problem, {.limits = {.absolute_gap = gap}});
        EXPECT_EQ(cold.status, SolveStatus::optimal);
        ASSERT_TRUE(cold.lane_graph);
        EXPECT_TRUE(is_feasible(problem, *cold.lane_graph));
    }
}

/// Cones on a lattice, with many walks of equal cost and cycles of cost zero: labels that improve only by
/// rounding must not lead to endless rounds.
TEST(PathPair, EndsWhereEverythingTies) {
    const std::unique_ptr<RldSolver> path_pair = make_path_pair_solver();
    const std::unique_ptr<RldSolver> cbc = kCbc.entry.make(Formulation::tight);
    for (const double spacing_m : {3.0, 3.2, 4.0}) {
        for (const double theta_t : {0.9, 2.0}) {
            SCOPED_TRACE(testing::Message() << spacing_m << " m, theta_t " << theta_t);
            Scene scene;
            for (ConeId id = 0; id < 15; ++id) {
                const Point step(static_cast<double>(id / 3), static_cast<double>(id % 3) - 1.0);
                scene.cones.push_back({id, Point(1.0, 0.0) + spacing_m * step});
            }
            RldParameters parameters{.theta_t = theta_t};
            (void)tests::agrees(solve(*path_pair, scene, parameters), solve(*cbc, scene, parameters));
        }
    }
}

/// For every deadline, the claim is true: the bound is below the optimum, and the lane graph is one.
TEST(PathPair, BoundsAndIncumbentsHoldAtEveryDeadline) {
    const std::unique_ptr<RldSolver> solver = make_path_pair_solver();
    int unfinished = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const Scene scene = tests::random_scene(seed, 24);
        RldParameters parameters;
        if (seed % 2 == 0) parameters.pairing = Pairing::paper;
        const RldReport optimum = solve(*solver, scene, parameters);
        for (const double limit_ms : {0.0, 0.01, 0.03, 0.1, 0.3}) {
            SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << limit_ms << " ms");
            const RldReport report = solve(*solver, scene, parameters, limit_ms);
            ASSERT_NE(report.status, SolveStatus::error);
            EXPECT_EQ(report.lane_graph.has_value(), report.objective.has_value());
            if (report.status == SolveStatus::infeasible) {
                EXPECT_EQ(optimum.status, SolveStatus::infeasible);
                continue;
            }
            if (!report.bound) {  // stopped before the search began
                ASSERT_EQ(report.status, SolveStatus::stopped);
                continue;
            }
            if (report.status != SolveStatus::optimal) ++unfinished;
            if (optimum.objective) {
                EXPECT_LE(*report.bound, *optimum.objective + 1e-9);
            }
            if (!report.lane_graph) continue;
            const Claim claim{report.status == SolveStatus::optimal, *report.objective, report.bound};
            EXPECT_THAT(check(scene, parameters, *report.lane_graph, claim).violations, testing::IsEmpty());
        }
    }
    EXPECT_GT(unfinished, 20);
}

/// The time ends at each check of the clock in turn: a claimed complete search is complete, and the bound is
/// valid. It never falls, and rises on the way if nodes branch.
TEST(PathPair, ADeadlineAtAnyCheckMakesNoFalseProof) {
    int cut_short = 0;
    int rises = 0;
    std::uint64_t run = 0;
    for (std::uint64_t seed = 0; seed < 16; ++seed) {
        const LaneGraphProblem problem = make_problem(tests::random_scene(seed, 30), {});
        SearchClock no_limit;
        ArcGraph graph;
        graph.build(problem, no_limit);
        const LegSystem system = tests::near_to_far(graph);
        Incumbent incumbent(graph);
        PathPairOptions options;
        if (run++ % 2 == 1) options = {.search_frontiers = false, .root_steps = 10, .node_steps = 5};
        tests::FakeSearchClock clock;
        BranchAndBound search(graph, system, incumbent, options, clock);
        constexpr double kTolerance = 1e-9;
        incumbent.reset(0.0, kTolerance);
        ASSERT_TRUE(search.run().complete);
        const int looks = clock.looks();
        const double optimum = incumbent.cutoff();
        double bound_before = -kUnreachable;
        for (int strike = 1; strike <= looks + 1; strike += 1 + looks / 200) {
            SCOPED_TRACE(testing::Message() << "seed " << seed << ", look " << strike << " of " << looks);
            clock.restart(strike);
            incumbent.reset(0.0, kTolerance);
            const BranchAndBound::Outcome outcome = search.run();
            EXPECT_GE(incumbent.cutoff(), optimum - kTolerance);
            EXPECT_LE(outcome.bound, optimum + kTolerance);
            EXPECT_GE(outcome.bound, bound_before - 1e-6);
            if (outcome.bound > bound_before + 1e-6) ++rises;
            bound_before = outcome.bound;
            if (outcome.complete) {
                EXPECT_NEAR(incumbent.cutoff(), optimum, 2.0 * kTolerance);
            } else {
                ++cut_short;
            }
        }
    }
    EXPECT_GT(cut_short, 100);
    EXPECT_GT(rises, 100);
}

TEST(PathPair, TakesLargeConeSets) {
    const std::unique_ptr<RldSolver> solver = make_path_pair_solver();
    for (const Pairing pairing : {Pairing::near_far, Pairing::paper}) {
        boost::random::mt19937_64 random(7);
        boost::random::uniform_real_distribution<double> ahead(0.0, 60.0);
        boost::random::uniform_real_distribution<double> across(-30.0, 30.0);
        Scene scene;
        for (ConeId id = 0; id < 512; ++id) {
            const double x = ahead(random);
            scene.cones.push_back({id, {x, across(random)}});
        }
        RldParameters parameters{.pairing = pairing};
        const RldReport report = solve(*solver, scene, parameters, 100.0);
        ASSERT_NE(report.status, SolveStatus::error);
        if (!report.lane_graph) continue;
        EXPECT_THAT(
            check(scene, parameters, *report.lane_graph, {false, *report.objective, report.bound}).violations,
            testing::IsEmpty());
    }
}

/// The verifier finds the root's bound again from the scene, below the optimum. It rejects a higher claim, a
/// multiplier below zero and an invalid clique.
TEST(PathPairCertificate, IsVerifiedAndCannotBeForged) {
    const std::unique_ptr<RldSolver> solver = make_path_pair_solver();
    for (const RldParameters& parameters : {RldParameters{}, with_shape_costs({})}) {
        int forged_cliques = 0;
        int bounded = 0;
        for (std::uint64_t seed = 0; seed < 40; ++seed) {
            SCOPED_TRACE(testing::Message()
                         << "seed " << seed << ", shape costs: " << has_shape_costs(parameters));
            const Scene scene = tests::random_scene(seed, 16);
            const RldReport optimum = solve(*solver, scene, parameters);
            BoundCertificate certificate = certify_root_bound(make_problem(scene, parameters));
            const BoundVerdict verdict = verify_bound(scene, parameters, certificate);
            EXPECT_THAT(verdict.violations, testing::IsEmpty());
            ASSERT_TRUE(verdict.bound);
            if (optimum.objective) {
                ASSERT_EQ(optimum.status, SolveStatus::optimal);
                EXPECT_LE(*verdict.bound, *optimum.objective + 1e-9);
                BoundCertificate higher = certificate;
                higher.bound = *verdict.bound + 1e-3;
                EXPECT_THAT(verify_bound(scene, parameters, higher).violations, testing::SizeIs(1));
                ++bounded;
            }
            RldParameters other_pairing = parameters;
            other_pairing.pairing = Pairing::paper;
            EXPECT_THAT(verify_bound(scene, other_pairing, certificate).violations,
                        testing::Contains(testing::HasSubstr("pairing")));
            for (const BoundCertificate::Clique& clique : certificate.cliques) {
                // An edge does not exclude itself.
                BoundCertificate wrong = certificate;
                wrong.cliques = {{{clique.edges.front(), clique.edges.front()}, clique.multiplier}};
                EXPECT_FALSE(verify_bound(scene, parameters, wrong).violations.empty());
                ++forged_cliques;
            }
            certificate.cone_multiplier.front() = -0.1;
            EXPECT_FALSE(verify_bound(scene, parameters, certificate).violations.empty());
        }
        EXPECT_GT(forged_cliques, 0);
        EXPECT_GT(bounded, 20);
    }
}

/// In doubles, such multipliers hide that two edges cost -1 each.
TEST(PathPairCertificate, HugeMultipliersProveNoBoundByRounding) {
    const Scene scene = tests::cones_at({{4, 1.5}, {7.2, 1.5}, {4, -1.5}, {7.2, -1.5}});
    for (const double multiplier : {1.0, 1e15, 1e17, 1e20, 1e300}) {
        const BoundCertificate certificate{std::vector<double>(4, multiplier), {}, 0.0, -1.0};
        EXPECT_THAT(verify_bound(scene, {}, certificate).violations, testing::SizeIs(1)) << multiplier;
    }
}

/// The verifier uses the same shape costs as the solver: it finds the same bound, and nearly always a lower
/// one if one of them is cheaper. Edges that join no nearest cones count among those that face an edge.
TEST(PathPairCertificate, RestsOnEveryShapeCost) {
    std::vector<int> refused(3, 0);
    int finite = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        RldParameters parameters = with_shape_costs({});
        parameters.nearest_of_edge = seed % 4 == 3 ? 3.0 : 0.0;
        std::vector<RldParameters> cheaper(refused.size(), parameters);
        cheaper[0].unevenness_weight = 0.0;
        cheaper[1].facing_weight = 0.0;
        cheaper[2].near_end_weight *= 1.5;
        const Scene scene = tests::random_scene(seed, 16);
        const BoundCertificate certificate = certify_root_bound(make_problem(scene, parameters));
        const BoundVerdict verdict = verify_bound(scene, parameters, certificate);
        ASSERT_TRUE(verdict.bound);
        if (!std::isfinite(*verdict.bound)) continue;
        ++finite;
        EXPECT_NEAR(*verdict.bound, certificate.bound, 1e-6);
        for (std::size_t k = 0; k < cheaper.size(); ++k) {
            if (!verify_bound(scene, cheaper[k], certificate).violations.empty()) ++refused[k];
        }
    }
    EXPECT_GT(finite, 20);
    EXPECT_THAT(refused, testing::Each(testing::Gt(finite * 3 / 4)));
}

/// Cones of random colors; every third one has probabilities.
Scene colored_scene(std::uint64_t seed, std::size_t cones) {
    Scene scene = tests::random_scene(seed, cones);
    boost::random::mt19937_64 random(seed + 1000);
    boost::random::uniform_real_distribution<double> any(0.0, 0.5);
    for (std::size_t i = 0; i < scene.cones.size(); ++i) {
        scene.cones[i].color = i % 2 == 0 ? ConeColor::blue : ConeColor::yellow;
        scene.cones[i].confidence = 0.5 + any(random);
        if (i % 3 != 0) continue;
        const double blue = any(random);
        const double yellow = any(random);
        scene.cones[i].color_probabilities =
            ColorProbabilities{.unknown = 1.0 - blue - yellow, .blue = blue, .yellow = yellow};
    }
    return scene;
}

/// Also with learned costs, edges over gaps and costs of color the verifier finds the root's bound again, and
/// refuses a bound that is higher or proven by other costs.
TEST(PathPairCertificate, OfLearnedCostsIsVerifiedAndCannotBeForged) {
    const std::unique_ptr<RldSolver> solver = make_path_pair_solver();
    int bounded = 0;
    int gaps = 0;
    std::vector<int> refused(6, 0);
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene = colored_scene(seed, 14);
        RldParameters parameters{.w_color = 0.3,
                                 .use_confidence = true,
                                 .d_gap = 9.0,
                                 .theta_gap = 0.5,
                                 .d_clear = 0.5,
                                 .d_side = seed % 3 == 0 ? 2.5 : 0.0,
                                 .nearest_of_edge = static_cast<double>(seed % 6),
                                 .nearest_of_gap = static_cast<double>(seed % 9),
                                 .learned_costs = tests::random_learned_costs(seed, seed % 2 == 0 ? 0 : 5)};
        const BoundCertificate certificate = certify_root_bound(make_problem(scene, parameters));
        const BoundVerdict verdict = verify_bound(scene, parameters, certificate);
        EXPECT_THAT(verdict.violations, testing::IsEmpty());
        ASSERT_TRUE(verdict.bound);
        const RldReport optimum = solve(*solver, scene, parameters);
        if (!optimum.objective || !std::isfinite(*verdict.bound)) continue;
        ASSERT_EQ(optimum.status, SolveStatus::optimal);
        ++bounded;
        EXPECT_NEAR(*verdict.bound, certificate.bound, 1e-6);
        EXPECT_LE(*verdict.bound, *optimum.objective + 1e-9);
        BoundCertificate higher = certificate;
        higher.bound = *verdict.bound + 1e-5;
        EXPECT_THAT(verify_bound(scene, parameters, higher).violations, testing::SizeIs(1));
        const LaneGraphProblem problem = make_problem(scene, parameters);
        gaps += std::ranges::any_of(optimum.lane_graph->edges, [&](const Edge& edge) {
            return (scene.cones[edge.i].position - scene.cones[edge.j].position).norm() > 6.0;
        });

        // Costs of one kind each that are cheaper than those that the bound is of.
        for (std::size_t k = 0; k < refused.size(); ++k) {
            RldParameters cheaper = parameters;
            LearnedCosts costs = *parameters.learned_costs;
            if (k < kLearnedParts.size()) {
                LearnedNetwork& network = costs.of(kLearnedParts[k]);
                network.linear[0] -= 0.2;
            } else if (k == kLearnedParts.size()) {
                cheaper.w_color = 0.0;
            } else {
                costs.of(LearnedPart::edge).linear[12] -= 0.3;  // color_cost
            }
            cheaper.learned_costs = std::make_shared<const LearnedCosts>(std::move(costs));
            if (!verify_bound(scene, cheaper, certificate).violations.empty()) ++refused[k];
        }
    }
    EXPECT_GT(bounded, 40);
    EXPECT_GT(gaps, 5);
    EXPECT_THAT(refused, testing::Each(testing::Gt(bounded / 3)));
}

/// A clique of a certificate may rest on a gap: two edges that meet at an angle that only edges within s_crit
/// may have. Without gaps they may go together nowhere, since one of them is not allowed.
TEST(PathPairCertificate, CliquesMayRestOnGaps) {
    // Six metres straight on to a pair of cones 2.8 m apart, and a third one at an angle of 1 rad.
    const Scene scene = tests::cones_at({{0.0, 0.0}, {7.0, 0.0}, {9.8, 0.0}, {8.5, 2.34}});
    RldParameters parameters{.d_min = 0.1, .t_crit = 100.0, .d_gap = 9.0, .theta_gap = 0.5};
    BoundCertificate certificate{std::vector<double>(4, 0.0), {{{{0, 1}, {1, 3}}, 0.1}}, 0.0, -100.0};
    EXPECT_THAT(verify_bound(scene, parameters, certificate).violations, testing::IsEmpty());
    certificate.cliques.front().edges = {{0, 1}, {1, 2}};
    EXPECT_THAT(verify_bound(scene, parameters, certificate).violations,
                testing::ElementsAre(testing::HasSubstr("may go together")));
}

/// With bounds of one step each, the proof needs branching, first on ends and then on edges.
TEST(PathPair, BranchingAloneFindsTheOptimum) {
    PathPairOptions options;
    options.search_frontiers = options.complete_walks = options.clique_multipliers = options.fix_arcs = false;
    options.root_steps = options.node_steps = 1;
    const std::unique_ptr<RldSolver> branching = make_path_pair_solver(options);
    const std::unique_ptr<RldSolver> exhaustive = make_exhaustive_solver();
    int with_lane = 0;
    std::int64_t nodes = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        RldParameters parameters{.pairing = seed % 2 == 0 ? Pairing::near_far : Pairing::paper};
        const LaneGraphProblem problem = make_problem(tests::random_scene(seed, 8), parameters);
        const RldReport expected = exhaustive->solve(problem, {});
        const RldReport report = branching->solve(problem, {});
        nodes += report.nodes;
        with_lane += tests::agrees(report, expected, 1e-9) ? 1 : 0;
    }
    EXPECT_GT(with_lane, 15);
    EXPECT_GT(nodes, 1000);
}

/// If edges cost more than they gain, the rest of a leg has a positive cost too: arcs are dropped only by the
/// sum of both parts of a leg.
TEST(PathPair, FixesNoArcOfTheOptimumWhereEdgesCostMoreThanTheyGain) {
    RldParameters parameters{.w_s = 1.0, .w_b = 0.05};
    const std::unique_ptr<RldSolver> fixing = make_path_pair_solver();
    PathPairOptions options{.fix_arcs = false};
    const std::unique_ptr<RldSolver> keeping = make_path_pair_solver(options);
    int dear = 0;
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const LaneGraphProblem problem = make_problem(tests::random_scene(seed, 18), parameters);
        const RldReport expected = keeping->solve(problem, {});
        const bool has_lane = tests::agrees(fixing->solve(problem, {}), expected, 1e-9);
        dear += has_lane && *expected.objective > 0.0 ? 1 : 0;
    }
    EXPECT_GT(dear, 80);
}

}  // namespace
}  // namespace conelane::path_pair
