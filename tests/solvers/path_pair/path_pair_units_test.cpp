// The units of path-pair: valid bounds, valid cliques, and the same legs as brute force finds.

#include "solvers/path_pair/bound/leg_search.hpp"
#include "solvers/path_pair/bound/smoothed_ascent.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "solvers/path_pair/primal/incumbent.hpp"
#include "tests/support/clocks/fake_search_clock.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/near_to_far.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/six_cone_lane.hpp"

namespace conelane::path_pair {
namespace {

using tests::six_cone_lane;

/// A scene's arcs with multipliers such that no cycle costs less than 0, and legs from near to far cones.
struct SceneWithMultipliers {
    explicit SceneWithMultipliers(std::uint64_t seed, std::size_t cones = 9) {
        const Scene scene = tests::random_scene(seed, cones);
        graph.build(make_problem(scene, {}), clock);
        residual.assign(graph, tests::near_to_far(graph).kinds[0].start, clock);
        multipliers.cone.assign(cones, 0.0);
        boost::random::mt19937_64 random(seed);
        for (double& multiplier : multipliers.cone)
            multiplier = boost::random::uniform_real_distribution<double>(0.0, 0.5)(random);
        do {
            reduce(graph, cliques, multipliers, residual, edge_multiplier, reduced);
            start.clear();
            end.clear();
            for (int a = 0; a < residual.size(); ++a) {
                const std::size_t at = to_index(a);
                const int tail = residual.tail[at];
                start.push_back(graph.near(tail) ? multipliers.cone[to_index(tail)] : kUnreachable);
                end.push_back(graph.near(residual.head[at]) ? kUnreachable : 0.25);
            }
            if (bounds.forward(residual, reduced, start, forward, before, cycle)) break;
            raise_cycles(residual, cycle, reduced, multipliers.cone);
            ++raised;
        } while (true);
        bounds.backward(residual, reduced, end, std::vector<char>(residual.arc.size(), 1), backward);
    }

    /// Every simple leg without incompatible edges, by plain recursion.
    void for_each_leg(const std::function<void(const std::vector<int>&, double)>& visit) const {
        std::vector<int> leg;
        std::vector<char> used(to_index(graph.cone_count()), 0);
        const std::function<void(int, double)> extend = [&](int a, double cost) {
            const std::size_t at = to_index(a);
            const std::size_t head = to_index(residual.head[at]);
            if (used[head] != 0) return;
            for (const int other : leg) {
                if (graph.incompatible(residual.edge(other), residual.edge(a))) return;
            }
            cost += reduced[at];
            used[head] = 1;
            leg.push_back(a);
            if (end[at] < kUnreachable) visit(leg, cost + end[at]);
            for (int p = residual.out_start[at]; p < residual.out_start[at + 1]; ++p)
                extend(residual.out_arc[to_index(p)], cost + residual.out_cost[to_index(p)]);
            leg.pop_back();
            used[head] = 0;
        };
        for (int a = 0; a < residual.size(); ++a) {
            const std::size_t at = to_index(a);
            if (start[at] == kUnreachable) continue;
            used[to_index(residual.tail[at])] = 1;
            extend(a, start[at]);
            used[to_index(residual.tail[at])] = 0;
        }
    }

    SearchClock clock;
    ArcGraph graph;
    ResidualGraph residual;
    CliquePool cliques;
    Multipliers multipliers;
    LegBounds bounds{clock};
    std::vector<double> edge_multiplier, reduced, start, end, forward, backward;
    std::vector<int> before, cycle;
    int raised = 0;
};

class Offers {
  public:
    Offers(const Scene& scene, const RldParameters& parameters) {
        SearchClock clock;
        graph.build(make_problem(scene, parameters), clock);
        incumbent.reset(0.0, 0.0);
    }
    bool offer(const std::vector<int>& first_cones, const std::vector<int>& second_cones) {
        return incumbent.offer(leg(first_cones), leg(second_cones));
    }
    [[nodiscard]] std::vector<int> leg(const std::vector<int>& cones) const {
        std::vector<int> arcs;
        for (std::size_t k = 1; k < cones.size(); ++k) arcs.push_back(graph.arc(cones[k - 1], cones[k]));
        return arcs;
    }

    ArcGraph graph;
    Incumbent incumbent{graph};
};

/// The multipliers need no repair. Their bound is below the optimum, in the mean by 1.24, the gap of the
/// linear program included.
TEST(PathPairSmoothedAscent, FindsMultipliersOfAGoodBound) {
    const AscentTuning tuning;
    double gap = 0.0;
    int count = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        SceneWithMultipliers scene(seed, 16);
        const LegSystem system = tests::near_to_far(scene.graph);
        Multipliers multipliers;
        SmoothedAscent smoothed(scene.graph, system, tuning, scene.clock);
        ASSERT_TRUE(smoothed.find(scene.residual, scene.cliques, multipliers));
        ASSERT_EQ(to_index(scene.cliques.size()), multipliers.clique.size());
        Decisions decisions;
        decisions.reset(scene.graph);
        PairRelaxation relaxation(scene.graph, system, scene.cliques, decisions, scene.clock);
        const std::vector<double> cones = multipliers.cone;
        const double bound = relaxation.evaluate(scene.residual, multipliers);
        for (std::size_t v = 0; v < cones.size(); ++v) {
            EXPECT_GE(cones[v], 0.0);
            EXPECT_NEAR(multipliers.cone[v], cones[v], 1e-9) << "a cycle gained";
        }
        const RldReport report =
            make_path_pair_solver()->solve(make_problem(tests::random_scene(seed, 16), {}), {});
        if (report.status != SolveStatus::optimal) continue;
        EXPECT_LE(bound, *report.objective + 1e-9);
        gap += *report.objective - bound;
        ++count;
    }
    ASSERT_GT(count, 20);
    EXPECT_LT(gap / count, 1.5);
}

TEST(PathPairSmoothedAscent, LeavesTheMultipliersOnceTheTimeHasEnded) {
    const SceneWithMultipliers scene(1);
    const AscentTuning tuning{.sweeps = 2000};
    const LegSystem system = tests::near_to_far(scene.graph);
    for (int looks = 0; looks < 20; ++looks) {
        tests::FakeSearchClock clock(looks + 1);
        SmoothedAscent smoothed(scene.graph, system, tuning, clock);
        Multipliers multipliers = scene.multipliers;
        CliquePool cliques;
        EXPECT_FALSE(smoothed.find(scene.residual, cliques, multipliers));
        EXPECT_EQ(multipliers.cone, scene.multipliers.cone);
    }
}

TEST(PathPairIncumbent, TakesLaneGraphsThatCostLess) {
    Offers lane(six_cone_lane(), {});
    EXPECT_TRUE(lane.offer({1, 2}, {3, 4, 5}));
    EXPECT_NEAR(lane.incumbent.cutoff(), -3.0, 1e-9);
    EXPECT_TRUE(lane.offer({0, 1, 2}, {3, 4, 5}));
    EXPECT_NEAR(lane.incumbent.cutoff(), -4.0, 1e-9);
    EXPECT_FALSE(lane.offer({0, 1, 2}, {3, 4, 5})) << "no cheaper";
    EXPECT_FALSE(lane.offer({1, 2}, {3, 4, 5}));
    EXPECT_EQ(lane.incumbent.edges().size(), 4U);
}

/// Windows take the first cone of a leg for its near end, whoever offered the legs.
TEST(PathPairIncumbent, TakesNoLegFromFarToNear) {
    Offers lane(six_cone_lane(), {});
    EXPECT_FALSE(lane.offer({2, 1, 0}, {3, 4, 5}));
    EXPECT_FALSE(lane.offer({0, 1, 2}, {5, 4, 3}));
    EXPECT_FALSE(lane.offer({2, 1, 0}, {5, 4, 3}));
    EXPECT_FALSE(lane.incumbent.goes_far()) << "there is none";
    EXPECT_TRUE(lane.offer({0, 1, 2}, {3, 4, 5}));
    EXPECT_TRUE(lane.incumbent.goes_far());
}

TEST(PathPairIncumbent, TakesNoLaneGraphWithoutTwoFarEndsThatFit) {
    EXPECT_FALSE(Offers(six_cone_lane(), {}).offer({0, 1}, {3, 4})) << "four near ends";
    RldParameters parameters;
    parameters.d_max = 3.4;  // 2 and 5 are 3.5 m apart
    EXPECT_FALSE(Offers(six_cone_lane(), parameters).offer({0, 1, 2}, {3, 4, 5})) << "too far apart";
}

/// Even if they have no cost: (5) allows a cone at most two edges.
TEST(PathPairIncumbent, TakesNoLegsThatPassOneCone) {
    RldParameters parameters{.d_min = 0.1, .t_crit = 1e6};
    Offers lane(six_cone_lane(), parameters);
    lane.incumbent.set_cutoff(1e6);
    EXPECT_FALSE(lane.offer({0, 1, 2}, {3, 1, 5}));
    EXPECT_TRUE(lane.offer({0, 1, 2}, {3, 4, 5}));
}

TEST(PathPairIncumbent, PaysForEveryTurn) {
    RldParameters parameters{.t_crit = 1e6};
    const Offers lane(six_cone_lane(), parameters);
    const double corner = 0.5 * std::pow(std::numbers::pi / 2.0 / 0.9, 4);
    const double across = lane.incumbent.leg_cost(lane.leg({1, 4}));
    EXPECT_NEAR(lane.incumbent.leg_cost(lane.leg({0, 1, 4, 5})), -1.0 + corner + across + corner - 1.0, 1e-9);
}

TEST(PathPairIncumbent, TakesNothingThatBreaksAConstraint) {
    RldParameters parameters{.d_min = 1.0, .t_crit = 1e6};
    EXPECT_FALSE(Offers(six_cone_lane(), parameters).offer({0, 1, 2}, {3, 4, 2})) << "both legs end at 2";
    parameters = {};
    parameters.d_min = 3.6;
    EXPECT_FALSE(Offers(six_cone_lane(1.6), parameters).offer({0, 1, 2}, {3, 4, 5})) << "too narrow";
    parameters = {};
    parameters.d_h = 2.1;  // 0 - 1 and 3 - 4 alone are near enough to the car
    EXPECT_FALSE(Offers(six_cone_lane(), parameters).offer({0, 1, 2}, {4, 5}))
        << "one edge along the heading";
    EXPECT_TRUE(Offers(six_cone_lane(), parameters).offer({0, 1, 2}, {3, 4, 5}));
}

/// For one boundary alone: each cone has half of its edges, and its turn.
TEST(PathPairArcGraph, SharesOfConesAddUpToTheLane) {
    LaneGraphProblem problem;  // GCC warns falsely of a member where all are named in braces
    problem.cone_count = 3;
    problem.near = {true, true, false};
    for (const std::size_t i : {0U, 1U})
        problem.edges.push_back({i, i + 1, 0.0, 0.0, 0.0, 0.0, -1.0, true, false});
    problem.turns.push_back({0, 1, 1, 0.0, 0.0, 0.25, false});
    ArcGraph graph;
    SearchClock clock;
    ASSERT_TRUE(graph.build(problem, clock));
    EXPECT_DOUBLE_EQ(graph.share_bound(), -0.5 + (-0.5 + 0.25 - 0.5) - 0.5);
}

TEST(PathPairLegBounds, NoLegThroughAnArcCostsLessThanItsLabels) {
    int legs = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const SceneWithMultipliers s(seed);
        s.for_each_leg([&](const std::vector<int>& leg, double cost) {
            ++legs;
            for (const int a : leg) {
                const std::size_t at = to_index(a);
                ASSERT_LE(s.forward[at] + s.backward[at], cost + 1e-9);
            }
        });
    }
    EXPECT_GT(legs, 1000);
}

TEST(PathPairLegBounds, ForwardAndBackwardAgreeOnTheShortestWalk) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        const SceneWithMultipliers s(seed, 14);
        double forth = kUnreachable;
        double back = kUnreachable;
        for (std::size_t a = 0; a < s.residual.arc.size(); ++a) {
            forth = std::min(forth, s.forward[a] + s.end[a]);
            back = std::min(back, s.start[a] + s.reduced[a] + s.backward[a]);
        }
        if (forth == kUnreachable) {
            EXPECT_EQ(back, kUnreachable);
        } else {
            EXPECT_NEAR(forth, back, 1e-9) << "seed " << seed;
        }
    }
}

/// Earlier walks are only a start: labels are the same from walks of other costs or graphs, and from none.
TEST(PathPairLegBounds, LabelsDoNotDependOnTheWalksTheyStartFrom) {
    SearchClock clock;
    LegBounds bounds(clock);
    std::vector<int> left_over;
    int started = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const SceneWithMultipliers s(seed);
        std::vector<double> cold, warm;
        std::vector<int> before, cycles;
        ASSERT_TRUE(bounds.forward(s.residual, s.reduced, s.start, cold, before, cycles));
        left_over.resize(s.residual.arc.size(), 0);
        // Walks of another graph, but with arcs of this one.
        for (int& arc : left_over) arc = std::min(arc, s.residual.size() - 1);
        started += static_cast<int>(left_over.size());
        ASSERT_TRUE(bounds.forward(s.residual, s.reduced, s.start, warm, left_over, cycles));
        for (std::size_t a = 0; a < cold.size(); ++a) {
            if (cold[a] < kUnreachable) {
                EXPECT_NEAR(warm[a], cold[a], 1e-9);
            } else {
                EXPECT_EQ(warm[a], kUnreachable);
            }
        }
    }
    EXPECT_GT(started, 500);
}

/// A loop over a far square of cones costs less than 0: its multipliers rise just until it costs 0.
TEST(PathPairLegBounds, APayingCycleIsRaisedUntilItIsNeutral) {
    RldParameters parameters{.theta_t = 2.0, .t_crit = 100.0};
    Scene scene = tests::cones_at({{4, 0}, {7.2, 0}, {7.2, 3.2}, {4, 3.2}});
    ArcGraph graph;
    SearchClock clock;
    graph.build(make_problem(scene, parameters), clock);
    ResidualGraph residual;
    residual.assign(graph, std::vector<char>{1, 0, 0, 0}, clock);
    Multipliers multipliers;
    multipliers.cone.assign(4, 0.0);
    LegBounds bounds(clock);
    std::vector<double> edge_multiplier, reduced, forward;
    std::vector<int> before, cycle;
    int raised = 0;
    while (true) {
        reduce(graph, {}, multipliers, residual, edge_multiplier, reduced);
        std::vector<double> start(residual.arc.size(), kUnreachable);
        for (std::size_t a = 0; a < start.size(); ++a) {
            if (residual.tail[a] == 0) start[a] = multipliers.cone[0];
        }
        if (bounds.forward(residual, reduced, start, forward, before, cycle)) break;
        raise_cycles(residual, cycle, reduced, multipliers.cone);
        ASSERT_LT(++raised, 20);
    }
    EXPECT_GT(raised, 0);
    for (const double multiplier : multipliers.cone) EXPECT_LT(multiplier, 1.0);
}

TEST(PathPairLegSearch, FindsTheLegsThatBruteForceFinds) {
    LegSearch search;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const SceneWithMultipliers s(seed);
        double best = kUnreachable;
        s.for_each_leg([&](const std::vector<int>&, double cost) { best = std::min(best, cost); });
        const double cutoff = best + 0.5;
        int expected = 0;
        s.for_each_leg([&](const std::vector<int>&, double cost) { expected += cost < cutoff ? 1 : 0; });
        int found = 0;
        std::int64_t budget = 1'000'000;
        const LegSearch::Query query{s.graph, s.residual, s.reduced, s.start, s.end, s.backward};
        EXPECT_TRUE(search.run(query, cutoff, budget, [&](std::span<const int>, double cost) {
            ++found;
            EXPECT_LT(cost, cutoff);
            return cutoff;
        }));
        EXPECT_EQ(found, expected);
    }
}

/// The reduced cost of a leg is its own cost plus the multipliers of what it uses.
TEST(PathPairMultipliers, ReducedCostOfALegIsItsCostPlusWhatItUses) {
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        SceneWithMultipliers s(seed);
        s.for_each_leg([&](const std::vector<int>& leg, double cost) {
            double sum = s.end[to_index(leg.back())] +
                         s.multipliers.cone[to_index(s.residual.tail[to_index(leg.front())])];
            for (std::size_t k = 0; k < leg.size(); ++k) {
                const std::size_t at = to_index(leg[k]);
                sum +=
                    s.graph.cost(s.residual.edge(leg[k])) + s.multipliers.cone[to_index(s.residual.head[at])];
                if (k > 0) {
                    sum += s.graph.turn_cost(s.residual.arc[to_index(leg[k - 1])], s.residual.arc[at]);
                }
            }
            ASSERT_NEAR(sum, cost, 1e-9) << "seed " << seed;
        });
    }
}

TEST(PathPairCliques, AreViolatedMaximalAndPairwiseIncompatible) {
    int found = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const SceneWithMultipliers s(seed, 20);
        const std::size_t edges = to_index(s.graph.edge_count());
        boost::random::mt19937_64 random(seed);
        std::vector<double> use;
        for (std::size_t e = 0; e < edges; ++e)
            use.push_back(boost::random::uniform_real_distribution<double>(0.0, 1.0)(random));
        CliquePool pool;
        CliqueSeparation separation;
        SearchClock clock;
        separation.separate(s.graph, use, std::vector<char>(edges, 1), 20, pool, clock);
        for (int q = 0; q < pool.size(); ++q) {
            ++found;
            const std::span<const int> clique = pool.edges(q);
            double sum = 0.0;
            for (const int e : clique) {
                sum += use[to_index(e)];
                for (const int f : clique) ASSERT_TRUE(e == f || s.graph.incompatible(e, f));
            }
            EXPECT_GT(sum, 1.0);
            for (int e = 0; e < s.graph.edge_count(); ++e)
                EXPECT_FALSE(std::ranges::all_of(clique, [&](int f) { return s.graph.incompatible(e, f); }));
        }
    }
    EXPECT_GT(found, 100);
}

}  // namespace
}  // namespace conelane::path_pair
