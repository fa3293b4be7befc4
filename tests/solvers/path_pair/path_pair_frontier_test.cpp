// No lane graph passes a frontier that path-pair drops; the search on the frontiers finds the best one.

#include "solvers/core_entries.hpp"
#include "solvers/path_pair/frontier/frontier_search.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "solvers/path_pair/primal/frontier_beam.hpp"
#include "solvers/path_pair/primal/pair_completion.hpp"
#include "tests/support/clocks/fake_search_clock.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/near_to_far.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/straight_lane_problem.hpp"

namespace conelane::path_pair {
namespace {

constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();

/// The frontiers of a problem, with random multipliers.
struct Frontiers {
    Frontiers(LaneGraphProblem lane_graph_problem, std::uint64_t seed)
        : problem(std::move(lane_graph_problem)) {
        graph.build(problem, clock);
        system = tests::near_to_far(graph);
        residual.assign(graph, system.kinds[0].start, clock);
        decisions.reset(graph);
        boost::random::mt19937_64 random(seed);
        for (int cone = 0; cone < graph.cone_count(); ++cone)
            multipliers.cone.push_back(boost::random::uniform_real_distribution<double>(0.0, 0.5)(random));
        leg_bound = relaxation.evaluate(residual, multipliers);
        edges.assign(graph, residual, clock);
        dominated.find(residual, relaxation, edges, true, clock);
        incumbent.reset(1e6, 1e-9);
    }

    bool build(double limit = kUnreachable, std::size_t max_frontiers = kAny) {
        return frontiers.build(residual, dominated, limit, max_frontiers);
    }

    /// Every walk on from a frontier to a last one that costs less than `limit`, by plain recursion.
    void for_each_walk_on(int f, double cost, double limit, std::vector<int>& arcs,
                          const std::function<void(double)>& visit) const {
        if (frontiers.is_last(f)) visit(cost);
        for (const FrontierGraph::Step& step : frontiers.steps(f)) {
            const double next = cost + frontiers.cost(step);
            if (!(next + frontiers.onward(step.to) < limit)) continue;
            if (step.arc >= 0) arcs.push_back(step.arc);
            for_each_walk_on(step.to, next, limit, arcs, visit);
            if (step.arc >= 0) arcs.pop_back();
        }
    }

    FrontierSearch::Outcome run(std::size_t width, std::size_t max_labels, bool with_detours = true) {
        tables.find(incumbent.cutoff() + relaxation.offset(), with_detours);
        return search.run({width, max_labels});
    }

    /// Every leg from a near to a far cone, by plain recursion.
    [[nodiscard]] std::vector<std::vector<int>> legs() const {
        std::vector<std::vector<int>> all;
        std::vector<int> leg;
        const std::function<void(int)> extend = [&](int a) {
            for (const int other : leg) {
                if (graph.incompatible(residual.edge(other), residual.edge(a)) ||
                    residual.tail[to_index(other)] == residual.head[to_index(a)]) {
                    return;
                }
            }
            leg.push_back(a);
            if (!graph.near(residual.head[to_index(a)])) all.push_back(leg);
            for (int p = residual.out_start[to_index(a)]; p < residual.out_start[to_index(a) + 1]; ++p)
                extend(residual.out_arc[to_index(p)]);
            leg.pop_back();
        };
        for (int a = 0; a < residual.size(); ++a) {
            if (graph.near(residual.tail[to_index(a)])) extend(a);
        }
        return all;
    }

    /// No cone and no incompatible edges in common.
    [[nodiscard]] bool are_pair(const std::vector<int>& first, const std::vector<int>& second) const {
        std::set<int> cones{residual.tail[to_index(first.front())]};
        for (const int a : first) cones.insert(residual.head[to_index(a)]);
        if (cones.contains(residual.tail[to_index(second.front())])) return false;
        return std::ranges::all_of(second, [&](int b) {
            return !cones.contains(residual.head[to_index(b)]) && std::ranges::none_of(first, [&](int a) {
                return graph.incompatible(residual.edge(a), residual.edge(b));
            });
        });
    }

    [[nodiscard]] int arc(int from, int to) const {
        const auto found = std::ranges::find(residual.arc, graph.arc(from, to));
        return static_cast<int>(found - residual.arc.begin());
    }

    LaneGraphProblem problem;
    tests::FakeSearchClock clock;
    ArcGraph graph;
    ResidualGraph residual;
    LegSystem system;
    CliquePool cliques;
    Decisions decisions;
    Multipliers multipliers;
    PairRelaxation relaxation{graph, system, cliques, decisions, clock};
    double leg_bound = 0.0;
    EdgeSets edges;
    DominatedEdges dominated;
    FrontierGraph frontiers{relaxation, clock};
    Incumbent incumbent{graph};
    OnwardTables tables{frontiers, edges, clock};
    FrontierSearch search{graph, relaxation, incumbent, frontiers, edges, tables, clock};
};

LaneGraphProblem random_problem(std::uint64_t seed, std::size_t cones = 9) {
    return make_problem(tests::random_scene(seed, cones), {});
}

/// Of a problem of all pairs those edges that a lane graph may have, and of their turns the allowed ones.
TEST(PathPairArcGraph, HasTheAllowedEdgesAndTurns) {
    const LaneGraphProblem all = make_problem(tests::random_scene(3, 9), {}, EdgeExtent::all_pairs);
    const LaneGraphProblem allowed = make_problem(tests::random_scene(3, 9), {});
    ArcGraph graph;
    SearchClock clock;
    ASSERT_TRUE(graph.build(all, clock));
    EXPECT_LT(static_cast<std::size_t>(graph.edge_count()), all.edges.size());
    EXPECT_EQ(static_cast<std::size_t>(graph.edge_count()), allowed.edges.size());
    for (int edge = 0; edge < graph.edge_count(); ++edge)
        EXPECT_FALSE(all.edges[graph.problem_edge(edge)].high_cost);
}

/// The turn from across to along is forbidden: no lane graph has both edges, so a clique may contain them.
TEST(PathPairArcGraph, EdgesOfAForbiddenTurnExcludeEachOther) {
    const Frontiers s(tests::straight_lane_problem(), 1);
    const int across = s.graph.arc(0, 1) / 2;
    const int along = s.graph.arc(1, 3) / 2;
    EXPECT_TRUE(s.graph.incompatible(across, along));
    EXPECT_TRUE(s.graph.incompatible(along, across));
    EXPECT_FALSE(s.graph.incompatible(s.graph.arc(0, 2) / 2, s.graph.arc(2, 4) / 2)) << "straight on";
}

/// 500 cones without an edge: if the time ends at any check, also among the far cones, there is no graph.
TEST(PathPairArcGraph, AnInterruptedBuildGivesNoGraph) {
    Scene scene;
    for (int cone = 0; cone < 500; ++cone)
        scene.cones.push_back({static_cast<ConeId>(cone), Point(100.0 + 100.0 * cone, 0.0)});
    const LaneGraphProblem problem = make_problem(scene, {});
    ArcGraph graph;
    tests::FakeSearchClock patient;
    ASSERT_TRUE(graph.build(problem, patient));
    const int all = patient.looks();
    ASSERT_GT(all, 3);
    for (int strike = 1; strike <= all; ++strike) {
        tests::FakeSearchClock clock(strike);
        EXPECT_FALSE(graph.build(problem, clock)) << strike;
        EXPECT_EQ(clock.looks(), strike);
    }
}

/// Three cones, around each of which a leg may turn at no cost: a round costs exactly 0, which is no gain.
TEST(PathPairLegBounds, ACycleOfCostZeroIsNotWalked) {
    const Scene scene = tests::cones_at({{1.0, -1.6}, {1.0, 1.6}, {1.0 + 1.6 * std::sqrt(3.0), 0.0}});
    RldParameters parameters{.w_t = 0.0, .t_crit = 1000.0};
    const LaneGraphProblem problem = make_problem(scene, parameters);
    ArcGraph graph;
    SearchClock clock;
    ASSERT_TRUE(graph.build(problem, clock));
    ResidualGraph residual;
    residual.assign(graph, std::vector<char>(3, 1), clock);
    ASSERT_EQ(residual.size(), 6);
    const std::vector<double> nothing(6, 0.0);
    std::vector<double> label;
    std::vector<int> before;
    std::vector<int> cycles;
    LegBounds bounds(clock);
    EXPECT_TRUE(bounds.forward(residual, nothing, nothing, label, before, cycles));
    EXPECT_EQ(label, nothing);
}

/// A leg could end only on 4 -> 6, which is left out, so no leg ends.
TEST(PathPairLegBounds, ALegDoesNotEndOnAnArcThatIsLeftOut) {
    Frontiers s(tests::straight_lane_problem(), 1);
    const auto count = static_cast<std::size_t>(s.residual.size());
    const auto last = to_index(s.arc(4, 6));
    std::vector<double> end(count, kUnreachable);
    end[last] = 0.0;
    std::vector<char> usable(count, 1);
    std::vector<double> label;
    LegBounds bounds(s.clock);
    const std::vector<double> nothing(count, 0.0);
    bounds.backward(s.residual, nothing, end, usable, label);
    EXPECT_EQ(label[to_index(s.arc(2, 4))], 0.0);
    usable[last] = 0;
    bounds.backward(s.residual, nothing, end, usable, label);
    EXPECT_EQ(label, std::vector<double>(count, kUnreachable));
}

/// Given 0 -> 1 -> 2, the best second leg is 5 -> 6 -> 7 at -1.998; 0 -> 3 -> 4 at -2 begins at a cone of the
/// first. Given that one, the best is 3 -> 0 -> 1 -> 2 at -3. Each is found at once, without a search over
/// legs.
///     4 ----- 3 ----- 0 ----- 1 ----- 2
///                   car >
///                     5 ----- 6 ---- 7
TEST(PathPairCompletion, TheSecondLegBeginsElsewhere) {
    Scene scene = tests::cones_at({{0.0, 1.75},
                                   {3.2, 1.75},
                                   {6.4, 1.75},
                                   {-3.2, 1.75},
                                   {-6.4, 1.75},
                                   {0.0, -1.75},
                                   {3.2, -1.75},
                                   {6.0, -1.75}});
    RldParameters parameters{.d_max = 16.0};
    Frontiers s(make_problem(scene, parameters), 1);
    s.relaxation.evaluate_backward(s.residual);
    SecondLegBound second(s.graph, s.clock);
    second.reset();
    PairCompletion completion(s.graph, s.relaxation, s.incumbent, second, s.clock);
    completion.complete(s.residual, 0, std::vector<int>{s.arc(0, 1), s.arc(1, 2)}, 0);
    ASSERT_TRUE(s.incumbent.found());
    EXPECT_NEAR(s.incumbent.cutoff(), -5.0 + 0.4 * std::pow(0.4 / 1.7, 4), 1e-9);
}

// A leg on 4 -> 6 has come over 0, 2 and 4. So {0, 2} is dominated: the other leg cannot use it, though it
// has no cone in common with {4, 6} and is not too close to it.
TEST(PathPairDominatedEdges, FollowedByHandOnAStraightLane) {
    Frontiers s(tests::straight_lane_problem(), 1);
    const int late = s.arc(4, 6);
    const int early = s.arc(0, 2);
    const int opposite = s.arc(1, 3);
    EXPECT_FALSE(s.dominated.may_pair(0, late, 0, early, true));
    EXPECT_TRUE(s.dominated.may_pair(0, late, 0, opposite, true));
    s.dominated.find(s.residual, s.relaxation, s.edges, false, s.clock);
    EXPECT_TRUE(s.dominated.may_pair(0, late, 0, early, true));
}

TEST(PathPairDominatedEdges, LetEveryPairOfLegsPass) {
    std::size_t pairs = 0;
    int dropped = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Frontiers s(random_problem(seed), seed);
        const std::vector<std::vector<int>> legs = s.legs();
        for (const std::vector<int>& first : legs) {
            for (const std::vector<int>& second : legs) {
                if (!s.are_pair(first, second)) continue;
                ++pairs;
                for (std::size_t k = 0; k + 1 < first.size(); ++k)
                    ASSERT_TRUE(s.dominated.may_follow(0, first[k], first[k + 1]));
                for (const int a : first) {
                    for (const int b : second) ASSERT_TRUE(s.dominated.may_pair(0, a, 0, b, false));
                }
            }
        }
        DominatedEdges alone;
        SearchClock clock;
        alone.find(s.residual, s.relaxation, s.edges, false, clock);
        for (int a = 0; a < s.residual.size(); ++a) {
            for (int b = 0; b < s.residual.size(); ++b) {
                const bool passes = s.dominated.may_pair(0, a, 0, b, false);
                dropped += alone.may_pair(0, a, 0, b, false) && !passes ? 1 : 0;
            }
        }
    }
    EXPECT_GT(pairs, 1000u);
    EXPECT_GT(dropped, 1000);
}

/// The frontiers' bound lies between that of single legs and the optimum, with dominated edges and without.
TEST(PathPairFrontierGraph, BoundsTheOptimumNoWorseThanSingleLegs) {
    const std::unique_ptr<RldSolver> exhaustive = make_exhaustive_solver();
    int with_lane = 0;
    int higher = 0;
    for (std::uint64_t seed = 0; seed < 80; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Frontiers s(random_problem(seed), seed);
        const RldReport best = exhaustive->solve(s.problem, {});
        const double optimum = best.objective.value_or(kUnreachable);
        with_lane += best.objective ? 1 : 0;
        ASSERT_TRUE(s.build());
        const double bound = s.frontiers.find_onward(kUnreachable) - s.relaxation.offset();
        EXPECT_GE(bound, s.leg_bound - 1e-9);
        EXPECT_LE(bound, optimum + 1e-9);
        s.frontiers.drop_dominated_edges(s.edges);
        s.frontiers.find_forward();
        const double thinned = s.frontiers.find_onward(kUnreachable) - s.relaxation.offset();
        EXPECT_GE(thinned, bound - 1e-9);
        EXPECT_LE(thinned, optimum + 1e-9);
        higher += thinned > s.leg_bound + 1e-6 ? 1 : 0;
    }
    EXPECT_GT(with_lane, 30);
    EXPECT_GT(higher, 30);
}

/// What two legs cost on to partners is no less than each of them alone, and no more than both abreast.
TEST(PathPairPartnerBounds, LieBetweenSingleLegsAndLegsAbreast) {
    int higher = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Frontiers s(random_problem(seed, 14), seed);
        ASSERT_TRUE(s.build());
        s.frontiers.find_onward(kUnreachable);
        std::vector<double> alone;
        s.relaxation.onward(s.residual, 0, alone);
        PartnerBounds partners;
        ASSERT_TRUE(partners.find(s.relaxation, s.residual, kUnreachable, s.clock));
        for (int f = 0; f < s.frontiers.size(); ++f) {
            const FrontierGraph::Frontier& here = s.frontiers.frontier(f);
            const double single =
                alone[to_index(here.moving)] + (here.ended ? 0.0 : alone[to_index(here.waiting)]);
            const double bound = here.ended ? partners.onward_to_partner(here.moving, here.waiting)
                                            : partners.onward(here.moving, here.waiting);
            ASSERT_GE(bound, single - 1e-9);
            const double abreast = s.frontiers.onward(f);
            ASSERT_TRUE(abreast == kUnreachable || bound <= abreast + 1e-9);
            higher += bound > single + 1e-6 && bound < 1e6 ? 1 : 0;
        }
    }
    EXPECT_GT(higher, 100);
}

/// Of both legs the one that stands earlier moves, so every pair is one walk.
TEST(PathPairFrontierGraph, TheEarlierLegMoves) {
    int both_go_on = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Frontiers s(random_problem(seed), seed);
        ASSERT_TRUE(s.build());
        for (int f = 0; f < s.frontiers.size(); ++f) {
            if (s.frontiers.frontier(f).ended) continue;
            EXPECT_LT(s.frontiers.frontier(f).moving, s.frontiers.frontier(f).waiting);
            ++both_go_on;
        }
    }
    EXPECT_GT(both_go_on, 20);
}

TEST(PathPairFrontierGraph, DropsOnlyWhatReachesTheLimit) {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Frontiers s(random_problem(seed, 14), seed);
        ASSERT_TRUE(s.build());
        const double bound = s.frontiers.find_onward(kUnreachable);
        if (bound == kUnreachable) continue;
        const int all = s.frontiers.size();
        s.frontiers.drop(bound + 0.5);
        EXPECT_LT(s.frontiers.size(), all);
        EXPECT_NEAR(s.frontiers.find_onward(kUnreachable), bound, 1e-9);
        EXPECT_EQ(s.frontiers.find_onward(bound), kUnreachable);
    }
}

TEST(PathPairFrontierGraph, GivesUpAtItsLimit) {
    Frontiers s(random_problem(3, 20), 3);
    EXPECT_FALSE(s.build(kUnreachable, 2));
    EXPECT_TRUE(s.build());
    s.clock.strike();
    EXPECT_FALSE(s.build());
}

/// If dominated edges are searched while the frontiers are built, there are fewer frontiers, the bound is not
/// lower, and the best pair stays.
TEST(PathPairFrontierGraph, LeavesOutDominatedEdgesWhileItIsBuilt) {
    const std::unique_ptr<RldSolver> solver = make_path_pair_solver({.search_frontiers = false});
    int fewer = 0;
    int with_lane = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Frontiers s(random_problem(seed, 24), seed);
        const std::optional<double> best = solver->solve(s.problem, {}).objective;
        if (!best) continue;
        ++with_lane;
        const double cutoff = *best + 4.0;
        const double limit = cutoff + s.relaxation.offset();
        ASSERT_TRUE(s.build(limit));
        const int all = s.frontiers.size();
        const double bound = s.frontiers.find_onward(limit);
        ASSERT_TRUE(s.frontiers.build(s.residual, s.dominated, limit, kAny, &s.edges));
        EXPECT_LE(s.frontiers.size(), all);
        fewer += s.frontiers.size() < all ? 1 : 0;
        EXPECT_GE(s.frontiers.find_onward(limit), bound - 1e-9);
        s.incumbent.reset(cutoff, 1e-9);
        s.run(FrontierSearch::kAnyWidth, kAny);
        EXPECT_NEAR(s.incumbent.cutoff(), *best, 1e-9);
    }
    EXPECT_GT(with_lane, 20);
    EXPECT_GT(fewer, 3);
}

/// A continuation that costs x more than the cheapest one uses no edge with a regret above x, and nothing
/// that an arc with a detour above x excludes.
TEST(PathPairOnwardTables, AreNoHigherThanAnyWalkOn) {
    std::size_t walks = 0;
    int regrets = 0;
    int detours = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Frontiers s(random_problem(seed, 10), seed);
        ASSERT_TRUE(s.build());
        const double bound = s.frontiers.find_onward(kUnreachable);
        if (bound == kUnreachable) continue;
        const double gap = 1.5;
        s.frontiers.drop(bound + gap);
        s.tables.find(bound + gap, true);
        for (int f = 0; f < s.frontiers.size(); ++f) {
            const double onward = s.frontiers.onward(f);
            std::vector<int> arcs;
            s.for_each_walk_on(f, 0.0, onward + gap, arcs, [&](double cost) {
                if (!(cost < onward + gap)) return;
                ++walks;
                const int most = s.tables.quanta_below(cost - onward);
                for (const int a : arcs) ASSERT_LE(s.tables.regrets(f)[s.edges.number(a)], most);
                for (int a = 0; a < s.residual.size(); ++a) {
                    const bool excludes = std::ranges::any_of(arcs, [&](int b) {
                        return EdgeSets::contains(s.edges.lost_after(a), s.edges.number(b));
                    });
                    if (excludes) continue;
                    ASSERT_LE(s.tables.detour(f, a), most);
                }
            });
            for (int a = 0; a < s.residual.size(); ++a) {
                const Quanta regret = s.tables.regrets(f)[s.edges.number(a)];
                regrets += regret > 0 && regret < kTooMany ? 1 : 0;
                const Quanta detour = s.tables.detour(f, a);
                detours += detour > 0 && detour < kTooMany ? 1 : 0;
            }
        }
    }
    EXPECT_GT(walks, 500u);
    EXPECT_GT(regrets, 100);
    EXPECT_GT(detours, 100);
}

/// A beam of one beginning at each arc follows both boundaries of a straight lane.
TEST(PathPairFrontierBeam, FindsTheStraightLane) {
    Frontiers s(tests::straight_lane_problem(), 1);
    FrontierBeam(s.graph, s.relaxation, s.incumbent, s.edges, s.clock).run(s.residual, 1);
    ASSERT_TRUE(s.incumbent.found());
    EXPECT_NEAR(s.incumbent.cutoff(), *make_exhaustive_solver()->solve(s.problem, {}).objective, 1e-9);
}

TEST(PathPairFrontierBeam, FindsLaneGraphsAndOftenTheBest) {
    const std::unique_ptr<RldSolver> exhaustive = make_exhaustive_solver();
    int with_lane = 0;
    int best_found = 0;
    for (std::uint64_t seed = 0; seed < 80; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Frontiers s(random_problem(seed), seed);
        const RldReport best = exhaustive->solve(s.problem, {});
        FrontierBeam(s.graph, s.relaxation, s.incumbent, s.edges, s.clock).run(s.residual, 8);
        if (!best.objective) {
            EXPECT_FALSE(s.incumbent.found());
            continue;
        }
        ++with_lane;
        if (!s.incumbent.found()) continue;
        EXPECT_GE(s.incumbent.cutoff(), *best.objective - 1e-9);
        best_found += s.incumbent.cutoff() < *best.objective + 1e-9 ? 1 : 0;
    }
    EXPECT_GT(2 * best_found, with_lane);
}

TEST(PathPairFrontierSearch, FindsTheBestOfAllLaneGraphs) {
    const std::unique_ptr<RldSolver> exhaustive = make_exhaustive_solver();
    int with_lane = 0;
    int narrow_ones = 0;
    for (std::uint64_t seed = 0; seed < 120; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Frontiers s(random_problem(seed), seed);
        const RldReport best = exhaustive->solve(s.problem, {});
        ASSERT_TRUE(s.build());
        if (s.frontiers.find_onward(kUnreachable) == kUnreachable) {
            EXPECT_FALSE(best.objective);
            continue;
        }
        // With only the cheapest beginning at each frontier, it finds a lane graph, but not always the best.
        const FrontierSearch::Outcome narrow = s.run(1, kAny);
        EXPECT_NE(narrow, FrontierSearch::Outcome::stopped);
        EXPECT_GE(s.incumbent.cutoff(), best.objective.value_or(1e6) - 1e-9);
        narrow_ones += narrow == FrontierSearch::Outcome::narrow ? 1 : 0;
        if (narrow == FrontierSearch::Outcome::exhausted) {
            EXPECT_NEAR(s.incumbent.cutoff(), best.objective.value_or(1e6), 1e-6) << "claimed to be all";
        }
        ASSERT_EQ(s.run(FrontierSearch::kAnyWidth, kAny), FrontierSearch::Outcome::exhausted);
        ASSERT_EQ(s.incumbent.found(), best.objective.has_value());
        if (!best.objective) continue;
        ++with_lane;
        EXPECT_NEAR(s.incumbent.cutoff(), *best.objective, 1e-6);
    }
    EXPECT_GT(with_lane, 50);
    EXPECT_GT(narrow_ones, 2);
}

/// If the time ends at any check, the search does not claim to be complete.
TEST(PathPairFrontierSearch, StopsAtEveryCheckOfTheClock) {
    int stopped_on_the_way = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        Frontiers s(random_problem(seed, 24), seed);
        ASSERT_TRUE(s.build());
        if (s.frontiers.find_onward(kUnreachable) == kUnreachable) continue;
        s.tables.find(1e6, true);
        bool struck = true;
        for (int strike = 1; struck && strike < 5; ++strike) {
            SCOPED_TRACE(testing::Message() << "seed " << seed << ", look " << strike);
            tests::FakeSearchClock clock(strike);
            s.incumbent.reset(1e6, 1e-9);
            FrontierSearch search(s.graph, s.relaxation, s.incumbent, s.frontiers, s.edges, s.tables, clock);
            const FrontierSearch::Outcome outcome = search.run({FrontierSearch::kAnyWidth, kAny});
            struck = clock.expired();
            ASSERT_EQ(outcome,
                      struck ? FrontierSearch::Outcome::stopped : FrontierSearch::Outcome::exhausted);
            stopped_on_the_way += struck && strike > 1 ? 1 : 0;
        }
    }
    EXPECT_GT(stopped_on_the_way, 5);
}

TEST(PathPairFrontierSearch, StopsAtItsLimit) {
    Frontiers s(random_problem(3, 20), 3);
    ASSERT_TRUE(s.build());
    s.frontiers.find_onward(kUnreachable);
    EXPECT_EQ(s.run(FrontierSearch::kAnyWidth, 5), FrontierSearch::Outcome::stopped);
    s.clock.strike();
    EXPECT_EQ(s.run(FrontierSearch::kAnyWidth, kAny), FrontierSearch::Outcome::stopped);
}

}  // namespace
}  // namespace conelane::path_pair
