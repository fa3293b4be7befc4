// Where path-pair looks for incumbents in a large graph: windows around a lane graph, and a beam over pairs.

#include "conelane/check.hpp"
#include "solvers/core_entries.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "solvers/path_pair/search/branch_and_bound.hpp"
#include "tests/support/clocks/fake_search_clock.hpp"
#include "tests/support/near_to_far.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/straight_lane_problem.hpp"

namespace conelane::path_pair {
namespace {

using Legs = std::array<std::vector<int>, 2>;

struct Graph {
    explicit Graph(const LaneGraphProblem& problem) {
        arcs.build(problem, clock);
        system = tests::near_to_far(arcs);
        whole.assign(arcs, system.kinds[0].start, clock);
        usable.assign(static_cast<std::size_t>(arcs.arc_count()), 1);
        incumbent.reset(0.0, 1e-9);
    }
    [[nodiscard]] std::vector<int> leg(std::span<const int> cones) const {
        std::vector<int> leg;
        for (std::size_t k = 0; k + 1 < cones.size(); ++k) leg.push_back(arcs.arc(cones[k], cones[k + 1]));
        return leg;
    }
    [[nodiscard]] static std::vector<int> marked(const std::vector<char>& marks) {
        std::vector<int> cones;
        for (std::size_t cone = 0; cone < marks.size(); ++cone) {
            if (marks[cone] != 0) cones.push_back(static_cast<int>(cone));
        }
        return cones;
    }

    SearchClock clock;
    ArcGraph arcs;
    LegSystem system;
    ResidualGraph whole;
    std::vector<char> usable;
    Incumbent incumbent{arcs};
    IncumbentWindow window{arcs, system, whole};
    PairBeam beam{arcs, system, clock};
};

// No arc of the lane leaves 6 or 7, so windows around them are empty and nothing changes. From 4, one arc
// leads to 6: the left leg may end anywhere behind it.
TEST(PathPairIncumbentWindow, FollowedByHandOnAStraightLane) {
    Graph s(tests::straight_lane_problem());
    const Legs legs{s.leg(std::vector<int>{0, 2, 4, 6}), s.leg(std::vector<int>{1, 3, 5, 7})};
    std::ranges::fill(s.usable, char{0});
    for (const std::vector<int>& leg : legs) {
        for (const int arc : leg) s.usable[to_index(arc)] = 1;
    }
    IncumbentWindow& window = s.window;
    window.assign(s.usable);
    window.restart(1);
    std::vector<int> arcs;
    for (const bool improved : {true, false, false}) {  // 6, tried again, and 7
        ASSERT_TRUE(window.next(legs, arcs));
        EXPECT_EQ(arcs.size(), 6U);
        EXPECT_EQ(window.system().kind_count, 2);
        for (std::size_t k = 0; k < 2; ++k) {
            EXPECT_EQ(Graph::marked(window.system().kinds[k].start), (std::vector<int>{static_cast<int>(k)}));
            EXPECT_EQ(Graph::marked(window.system().kinds[k].end),
                      (std::vector<int>{6 + static_cast<int>(k)}));
        }
        window.report(improved);
    }
    ASSERT_TRUE(window.next(legs, arcs));
    EXPECT_EQ(Graph::marked(window.system().kinds[0].start), (std::vector<int>{0}));
    EXPECT_EQ(window.system().kinds[0].end, s.system.kinds[0].end);
    EXPECT_EQ(Graph::marked(window.system().kinds[1].end), (std::vector<int>{7}));
    window.report(false);
    for (const int centre : {5, 2, 3}) {
        SCOPED_TRACE(centre);
        ASSERT_TRUE(window.next(legs, arcs));
        window.report(false);
    }
    EXPECT_FALSE(window.next(legs, arcs));
}

// One beginning at a time is enough on a straight lane.
TEST(PathPairBeam, FindsTheStraightLane) {
    const LaneGraphProblem problem = tests::straight_lane_problem();
    Graph s(problem);
    s.beam.find_first_steps();
    s.beam.run({1, 2}, s.incumbent);
    ASSERT_TRUE(s.incumbent.found());
    EXPECT_NEAR(s.incumbent.cutoff(), *make_exhaustive_solver()->solve(problem, {}).objective, 1e-9);
}

/// A beam does not depend on the beams that took first steps before it.
TEST(PathPairBeam, IsTheSameAfterOtherBeams) {
    int found = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Graph s(make_problem(tests::random_scene(seed, 30), {}));
        const auto cost = [&](PairBeam& beam, std::size_t width) {
            s.incumbent.reset(1e6, 1e-9);
            beam.run({width, 4}, s.incumbent);
            return s.incumbent.cutoff();
        };
        s.beam.find_first_steps();
        for (const std::size_t width : {2, 64, 1, 8}) {
            PairBeam fresh(s.arcs, s.system, s.clock);
            fresh.find_first_steps();
            EXPECT_EQ(cost(s.beam, width), cost(fresh, width));
            found += s.incumbent.found() ? 1 : 0;
        }
    }
    EXPECT_GT(found, 40);
}

TEST(PathPairBeam, FindsLaneGraphsAndOftenTheBest) {
    const std::unique_ptr<RldSolver> exhaustive = make_exhaustive_solver();
    int with_lane = 0;
    int best_found = 0;
    for (std::uint64_t seed = 0; seed < 80; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const LaneGraphProblem problem = make_problem(tests::random_scene(seed, 9), {});
        const RldReport best = exhaustive->solve(problem, {});
        Graph s(problem);
        s.incumbent.reset(1e6, 1e-9);
        s.beam.find_first_steps();
        s.beam.run({64, 16}, s.incumbent);
        if (!best.objective) {
            EXPECT_FALSE(s.incumbent.found());
            continue;
        }
        ++with_lane;
        if (!s.incumbent.found()) continue;
        EXPECT_GE(s.incumbent.cutoff(), *best.objective - 1e-9);
        best_found += s.incumbent.cutoff() < *best.objective + 1e-9 ? 1 : 0;
    }
    EXPECT_GT(4 * best_found, 3 * with_lane);
}

/// The legs are in every window, and only a fixed first or last arc excludes anything there.
TEST(PathPairIncumbentWindow, HoldsTheLegsAndWhatGoesWithTheirFixedEnds) {
    int fixed_ends = 0;
    int with_others = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Graph s(make_problem(tests::random_scene(seed, 30), {}));
        s.beam.find_first_steps();
        s.beam.run({16, 4}, s.incumbent);
        if (!s.incumbent.found()) continue;
        const Legs& legs = s.incumbent.legs();
        IncumbentWindow& window = s.window;
        window.assign(s.usable);
        window.restart(10 + seed);
        std::vector<int> arcs;
        while (window.next(legs, arcs)) {
            EXPECT_TRUE(std::ranges::is_sorted(arcs));
            std::vector<int> others = mapped(arcs, [&](const int a) { return s.whole.arc[to_index(a)]; });
            for (const std::vector<int>& leg : legs) {
                for (const int arc : leg) EXPECT_EQ(std::erase(others, arc), 1U);
            }
            with_others += others.empty() ? 0 : 1;
            const auto expect_fixed = [&](const std::vector<char>& ends, const std::vector<char>& all,
                                          int cone, int arc) {
                EXPECT_NE(ends[to_index(cone)], 0);
                if (ends == all) return;
                EXPECT_EQ(Graph::marked(ends).size(), 1U);
                ++fixed_ends;
                for (const int other : others) {
                    EXPECT_NE(s.arcs.tail(other), cone);
                    EXPECT_NE(s.arcs.head(other), cone);
                    EXPECT_FALSE(s.arcs.incompatible(other / 2, arc / 2));
                }
            };
            for (std::size_t k = 0; k < 2; ++k) {
                const LegSystem::Kind& kind = window.system().kinds[k];
                const LegSystem::Kind& all = s.system.kinds[0];
                expect_fixed(kind.start, all.start, s.arcs.tail(legs[k].front()), legs[k].front());
                expect_fixed(kind.end, all.end, s.arcs.head(legs[k].back()), legs[k].back());
            }
            window.report(false);
        }
    }
    EXPECT_GT(fixed_ends, 200);
    EXPECT_GT(with_others, 100);
}

struct Stopped {
    double cost = 0.0;
    BranchAndBound::Outcome outcome{};
    bool is_lane = true;
};

/// Until the clock has been checked this number of times.
Stopped search(const Scene& scene, const PathPairOptions& options, int looks) {
    const LaneGraphProblem problem = make_problem(scene, {});
    Graph s(problem);
    tests::FakeSearchClock clock(looks + 1);
    BranchAndBound search(s.arcs, s.system, s.incumbent, options, clock);
    const auto outcome = search.run();
    Stopped result{.cost = s.incumbent.cutoff(), .outcome = outcome};
    if (s.incumbent.found()) {
        LaneGraph lane;
        for (const int edge : s.incumbent.edges()) {
            const ProblemEdge& e = problem.edges[s.arcs.problem_edge(edge)];
            lane.edges.push_back({e.i, e.j});
        }
        std::ranges::sort(lane.edges);
        result.is_lane =
            check(scene, {}, lane, {false, result.cost, result.outcome.bound}).violations.empty();
    }
    return result;
}

/// In dense scenes, a search that continues has a lane graph that costs no more; with windows it costs less.
TEST(PathPairWindows, MakeNoIncumbentWorseAndManyBetter) {
    double with = 0.0;
    double without = 0.0;
    int stopped = 0;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
        const Scene scene = tests::strewn_scene(70, 25.0, 25.0, seed);
        double before = 0.0;
        for (const int looks : {50, 200, 800, 2000}) {
            SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << looks << " looks");
            const Stopped result = search(scene, {}, looks);
            EXPECT_TRUE(result.is_lane);
            EXPECT_LE(result.cost, before);
            EXPECT_LE(result.outcome.bound, result.cost + 1e-6);
            before = result.cost;
            stopped += result.outcome.complete ? 0 : 1;
            PathPairOptions options{.search_windows = false};
            const Stopped plain = search(scene, options, looks);
            with += result.cost;
            without += plain.cost;
        }
    }
    EXPECT_GT(stopped, 8);
    EXPECT_LT(with, without);
}

/// Its own lane graph stays a lane graph when windows improve it, whether one of its paths lists far ends
/// first or not. In these three scenes, a search that takes a start's paths in their given direction, and
/// does not check where the paths of an incumbent end, answers with one near end and three far ones.
TEST(PathPairWindows, AnImprovedStartIsALaneGraph) {
    struct Drawn {
        std::uint64_t seed;
        double d_near_m;
    };
    for (const auto& [seed, d_near_m] : {Drawn{2, 8.0}, Drawn{3, 8.0}, Drawn{7, 5.0}}) {
        for (const Pairing pairing : {Pairing::near_far, Pairing::paper}) {
            SCOPED_TRACE(testing::Message() << "seed " << seed << ", pairing " << static_cast<int>(pairing));
            const Scene scene = tests::strewn_scene(70, 25.0, 25.0, seed);
            RldParameters parameters{.d_near = d_near_m, .pairing = pairing};
            const LaneGraphProblem problem = make_problem(scene, parameters);
            const std::unique_ptr<RldSolver> solver = make_path_pair_solver();
            RldReport first;
            for (double limit_ms = 150.0; !first.lane_graph && limit_ms < 1e5; limit_ms *= 2.0)
                first = solver->solve(problem, {.limits = {.time_limit_ms = limit_ms}});
            ASSERT_TRUE(first.lane_graph);
            const RldReport again =
                solver->solve(problem, {.limits = {.time_limit_ms = 300.0}, .start = &*first.lane_graph});
            EXPECT_EQ(again.message, "");
            ASSERT_TRUE(again.lane_graph);
            EXPECT_LE(*again.objective, *first.objective + 1e-9);
            EXPECT_TRUE(check(scene, parameters, *again.lane_graph,
                              {again.status == SolveStatus::optimal, *again.objective, again.bound})
                            .violations.empty());
        }
    }
}

}  // namespace
}  // namespace conelane::path_pair
