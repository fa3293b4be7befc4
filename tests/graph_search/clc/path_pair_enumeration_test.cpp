#include "graph_search/clc/path_pair_enumeration.hpp"

#include "tests/support/lane_constraints_reference.hpp"

namespace conelane {
namespace {

constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max();
const Point kHeading(1.0, 0.0);

struct Result {
    bool complete;
    std::int64_t iterations;
    std::vector<PathPair> found;
    std::vector<PathPairVertices> vertices;
};

/// `nearest`: of StepReach.
Result enumerate(const std::vector<Point>& points, EnumerationRules rules,
                 std::int64_t iteration_limit = kNoLimit, std::size_t nearest = 0) {
    SearchGraph graph;
    graph.build(points, rules.d_max_m);
    StepReach reach;
    reach.reset(graph, nearest);
    rules.reach = &reach;
    SearchBudget budget;
    budget.iteration_limit = iteration_limit;
    PathPairs pairs;
    PathPairEnumeration enumeration;
    const bool complete = enumeration.run(graph, {0, 1}, kHeading, rules, budget, pairs);
    Result result{complete, budget.iterations, pairs.found(), {}};
    for (const PathPair& pair : pairs.found()) result.vertices.push_back(pairs.vertices(pair));
    return result;
}

/// Without closed pairs, which the definition of the solution set does not contain.
std::multiset<PathPairVertices> open_pairs(const Result& result) {
    std::multiset<PathPairVertices> pairs;
    for (std::size_t i = 0; i < result.found.size(); ++i) {
        if (!result.found[i].closed) pairs.insert(result.vertices[i]);
    }
    return pairs;
}

// Two cones a side: 0 and 2 on the left, 1 and 3 on the right, too far across to be joined.
//
// Iteration 1: both sides are equally advanced, and the tie goes to the smaller next vertex: l = (0, 2).
// Vertex 2 is now too far from the right boundary, which only the right can help: iteration 2, r = (1, 3), is
// forced and finds the lane. Iteration 3 sees no vertex left and returns, and so does iteration 4 one call
// above, where V holds both 2's dead end and 3. Iteration 5, in the first call, has visited 2 from 0; r = (1,
// 3) with l = (0) is too wide for 3, and the left cannot be extended: BTD. Iteration 6 ends the search.
TEST(PathPairEnumeration, FollowedByHandOnFourCones) {
    const Result result = enumerate({{1, 3}, {1, -3}, {5, 3}, {5, -3}}, {});
    EXPECT_TRUE(result.complete);
    EXPECT_EQ(result.iterations, 6);
    ASSERT_EQ(result.found.size(), 1u);
    EXPECT_THAT(result.vertices[0][kLeft], ElementsAre(0, 2));
    EXPECT_THAT(result.vertices[0][kRight], ElementsAre(1, 3));
    EXPECT_EQ(result.found[0].iteration, 2);
    EXPECT_FALSE(result.found[0].closed);
    EXPECT_DOUBLE_EQ(result.found[0].length_m, 4.0);
}

TEST(PathPairEnumeration, StopsAtTheIterationLimit) {
    const std::vector<Point> points{{1, 3}, {1, -3}, {5, 3}, {5, -3}};
    const Result stopped = enumerate(points, {}, 5);
    EXPECT_FALSE(stopped.complete);
    EXPECT_EQ(stopped.iterations, 5);
    EXPECT_TRUE(enumerate(points, {}, 6).complete);
    EXPECT_TRUE(enumerate(points, {}, 1).found.empty());
}

TEST(PathPairEnumeration, StopsAtTheDeadline) {
    SearchGraph graph;
    graph.build(std::vector<Point>{{1, 3}, {1, -3}, {5, 3}, {5, -3}}, 5.5);
    SearchBudget budget;
    budget.deadline = Deadline(0.0);
    PathPairs pairs;
    EXPECT_FALSE(PathPairEnumeration().run(graph, {0, 1}, kHeading, {}, budget, pairs));
    EXPECT_EQ(budget.stopped_by, StopReason::time);
    EXPECT_EQ(budget.iterations, 0);
}

/// Vertices 0 and 1 start left and right of the car, the others are anywhere ahead.
std::vector<Point> random_map(unsigned seed, unsigned size) {
    boost::random::mt19937_64 random(seed);
    boost::random::uniform_real_distribution<> ahead(-1.0, 11.0);
    boost::random::uniform_real_distribution<> across(-4.0, 4.0);
    std::vector<Point> points{{0.5, 1.9}, {0.3, -1.8}};
    while (points.size() < size) {
        const double x = ahead(random);
        points.emplace_back(x, across(random));
    }
    return points;
}

TEST(PathPairEnumeration, AddsWhatIsNotThereYet) {
    const std::vector<Point> points = random_map(3, 14);
    SearchGraph graph;
    graph.build(points, 5.5);
    PathPairs pairs;
    PathPairEnumeration enumeration;
    const auto run = [&](StartPair start, std::uint32_t max_discrepancies) {
        EnumerationRules rules{.max_discrepancies = max_discrepancies};
        SearchBudget budget;
        budget.iteration_limit = kNoLimit;
        EXPECT_TRUE(enumeration.run(graph, start, kHeading, rules, budget, pairs));
        return pairs.found().size();
    };
    const std::size_t few = run({0, 1}, 1);
    ASSERT_GT(few, 5u);
    EXPECT_EQ(run({0, 1}, 1), few) << "the same again";
    const std::size_t all = run({0, 1}, ~std::uint32_t{0});
    EXPECT_GT(all, few);
    EXPECT_GT(run({1, 0}, 1), all) << "the sides changed";
    pairs.clear();
    EXPECT_EQ(run({0, 1}, 1), few);
}

TEST(PathPairEnumeration, ClosesARing) {
    std::vector<Point> points;
    const auto on_ring = [&](double radius_m, int i) {
        const double angle = 2.0 * 3.14159265358979 * i / 12.0;
        return Point(radius_m * std::sin(angle), radius_m * (1.0 - std::cos(angle)) - radius_m + 9.0);
    };
    // A left-hand circuit: the inner ring is the left boundary.
    for (int i = 0; i < 12; ++i) {
        points.push_back(on_ring(6.0, i));
        points.push_back(on_ring(9.5, i));
    }
    const Result result = enumerate(points, {}, 2500);
    const auto closed = std::ranges::find_if(result.found, &PathPair::closed);
    ASSERT_NE(closed, result.found.end());
    const PathPairVertices& vertices =
        result.vertices[static_cast<std::size_t>(closed - result.found.begin())];
    EXPECT_EQ(vertices[kLeft].size(), 12u);
    EXPECT_EQ(vertices[kRight].size(), 12u);
    const double inner_m = 12 * 2 * 6.0 * std::sin(3.14159265358979 / 12);
    EXPECT_NEAR(closed->length_m, inner_m * (6.0 + 9.5) / 12.0, 1e-9);
}

/// All simple paths from a vertex that keep to d_max and C_seg, by definition.
void add_paths(const std::vector<Point>& points, const EnumerationRules& rules, std::vector<Vertex>& path,
               std::vector<std::vector<Vertex>>& paths) {
    paths.push_back(path);
    const std::size_t size = path.size();
    for (Vertex next = 0; next < points.size(); ++next) {
        if (std::ranges::count(path, next) > 0) continue;
        const Point segment = points[next] - points[path.back()];
        if (segment.norm() > rules.d_max_m) continue;
        // C_seg is applied here, because no extension can repair it: else there are too many paths to pair.
        if (size > 1 && std::abs(turning_angle(points[path.back()] - points[path[size - 2]], segment)) >=
                            rules.bounds.phi_max_rad) {
            continue;
        }
        path.push_back(next);
        add_paths(points, rules, path, paths);
        path.pop_back();
    }
}

/// Definition 1: the feasible ones among all pairs of paths, with at least two vertices a side.
std::multiset<PathPairVertices> feasible_by_definition(const std::vector<Point>& points,
                                                       const EnumerationRules& rules) {
    std::array<std::vector<std::vector<Vertex>>, 2> paths;
    for (const Side side : {kLeft, kRight}) {
        std::vector<Vertex> start{static_cast<Vertex>(side)};
        add_paths(points, rules, start, paths[side]);
    }
    const auto positions = [&](const std::vector<Vertex>& path) {
        return mapped(path, [&](const Vertex vertex) { return points[vertex]; });
    };
    std::multiset<PathPairVertices> feasible;
    for (const std::vector<Vertex>& left : paths[kLeft]) {
        if (left.size() < 2) continue;
        for (const std::vector<Vertex>& right : paths[kRight]) {
            if (right.size() < 2) continue;
            if (satisfies_constraints(positions(left), positions(right), rules.bounds)) {
                feasible.insert({left, right});
            }
        }
    }
    return feasible;
}

/// The number of feasible pairs of random maps, and of those that the search misses.
std::pair<std::size_t, std::size_t> feasible_and_missed(WidthBacktracking rule) {
    EnumerationRules rules{.width_backtracking = rule};
    std::size_t feasible = 0;
    std::size_t missed = 0;
    for (unsigned seed = 0; seed < 150; ++seed) {
        SCOPED_TRACE(seed);
        const std::vector<Point> points = random_map(seed, 5 + seed % 5);
        const Result result = enumerate(points, rules);
        EXPECT_TRUE(result.complete);
        const std::multiset<PathPairVertices> found = open_pairs(result);
        const std::multiset<PathPairVertices> expected = feasible_by_definition(points, rules);
        EXPECT_TRUE(std::ranges::includes(expected, found));
        feasible += expected.size();
        missed += expected.size() - found.size();
    }
    EXPECT_GT(feasible, 500u);
    return {feasible, missed};
}

// Theorem 4, with the backtracking that is proven: the search finds the whole feasible set, each path pair
// once. Giving up lanes that both boundaries have left behind finds nothing infeasible and rarely misses one.
TEST(PathPairEnumeration, IsCompleteOnRandomMapsAndMissesLittleOfWhatIsLeftBehind) {
    EXPECT_EQ(feasible_and_missed(WidthBacktracking::proven).second, 0u);
    const auto [feasible, missed] = feasible_and_missed(WidthBacktracking::left_behind);
    EXPECT_LT(static_cast<double>(missed), 0.02 * static_cast<double>(feasible))
        << missed << " of " << feasible;
}

/// By definition: for each step of a side after its start, the vertices not yet on that side that make a
/// smaller angle with its last segment (the heading at the start).
std::size_t discrepancies(const std::vector<Point>& points, double d_max_m, const PathPairVertices& lane) {
    std::size_t sum = 0;
    for (const std::vector<Vertex>& side : lane) {
        Point direction = kHeading;
        for (std::size_t i = 1; i < side.size(); ++i) {
            const Point& tip = points[side[i - 1]];
            const auto angle_rad = [&](Vertex next) {
                return std::abs(turning_angle(direction, points[next] - tip));
            };
            for (Vertex other = 0; other < points.size(); ++other) {
                const bool on_path = std::find(side.begin(), side.begin() + static_cast<std::ptrdiff_t>(i),
                                               other) != side.begin() + static_cast<std::ptrdiff_t>(i);
                if (on_path || (points[other] - tip).norm() > d_max_m) continue;
                if (angle_rad(other) < angle_rad(side[i])) ++sum;
            }
            direction = points[side[i]] - tip;
        }
    }
    return sum;
}

/// Expects of `found(points, seed)` the lanes that `keeps` on maps of which it keeps many and drops many.
void expect_only(
    const std::function<std::multiset<PathPairVertices>(const std::vector<Point>&, unsigned)>& found,
    const std::function<bool(const std::vector<Point>&, unsigned, const PathPairVertices&)>& keeps) {
    EnumerationRules all{.width_backtracking = WidthBacktracking::proven};
    std::size_t kept = 0;
    std::size_t left_out = 0;
    for (unsigned seed = 0; seed < 100; ++seed) {
        SCOPED_TRACE(seed);
        const std::vector<Point> points = random_map(seed, 6 + seed % 4);
        std::multiset<PathPairVertices> expected = open_pairs(enumerate(points, all));
        left_out +=
            std::erase_if(expected, [&](const PathPairVertices& lane) { return !keeps(points, seed, lane); });
        kept += expected.size();
        ASSERT_EQ(found(points, seed), expected);
    }
    EXPECT_GT(kept, 100u);
    EXPECT_GT(left_out, 100u);
}

TEST(PathPairEnumeration, LeavesOutWhatHasMoreDiscrepancies) {
    EnumerationRules few{.width_backtracking = WidthBacktracking::proven};
    expect_only(
        [&](const std::vector<Point>& points, unsigned seed) {
            few.max_discrepancies = seed % 4;
            return open_pairs(enumerate(points, few));
        },
        [&](const std::vector<Point>& points, unsigned seed, const PathPairVertices& lane) {
            return discrepancies(points, few.d_max_m, lane) <= seed % 4;
        });
}

/// By definition: whether no step goes to a vertex that `nearest` or more other neighbours are nearer than.
bool steps_are_near(const std::vector<Point>& points, double d_max_m, const PathPairVertices& lane,
                    std::size_t nearest) {
    for (const std::vector<Vertex>& side : lane) {
        for (std::size_t i = 1; i < side.size(); ++i) {
            const auto distance_m = [&](Vertex to) { return (points[to] - points[side[i - 1]]).norm(); };
            std::size_t nearer = 0;
            for (Vertex other = 0; other < points.size(); ++other) {
                if (other == side[i - 1] || distance_m(other) > d_max_m) continue;
                if (distance_m(other) < distance_m(side[i])) ++nearer;
            }
            if (nearer >= nearest) return false;
        }
    }
    return true;
}

TEST(PathPairEnumeration, LeavesOutStepsBeyondTheReach) {
    EnumerationRules rules{.width_backtracking = WidthBacktracking::proven};
    const auto nearest = [](unsigned seed) { return std::size_t{1} + seed % 3; };
    expect_only([&](const std::vector<Point>& points,
                    unsigned seed) { return open_pairs(enumerate(points, rules, kNoLimit, nearest(seed))); },
                [&](const std::vector<Point>& points, unsigned seed, const PathPairVertices& lane) {
                    return steps_are_near(points, rules.d_max_m, lane, nearest(seed));
                });
}

/// The second run meets only orders that the first one, from another start, has found.
TEST(PathPairEnumeration, MayShareTheNextVerticesOfEarlierRuns) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(seed);
        const std::vector<Point> points = random_map(seed, 11);
        EnumerationRules rules{.next_vertex_distance_weight = 1.45};
        SearchGraph graph;
        graph.build(points, rules.d_max_m);
        NextVertexDecider shared;
        shared.reset(graph, rules.next_vertex_distance_weight / rules.d_max_m);
        const auto found = [&](NextVertexDecider* next_vertex, const std::vector<StartPair>& starts) {
            rules.next_vertex = next_vertex;
            PathPairEnumeration enumeration;
            std::vector<std::vector<PathPairVertices>> result;
            for (const StartPair& start : starts) {
                PathPairs pairs;
                SearchBudget budget;
                budget.iteration_limit = 3000;
                (void)enumeration.run(graph, start, kHeading, rules, budget, pairs);
                result.emplace_back();
                for (const PathPair& pair : pairs.found()) result.back().push_back(pairs.vertices(pair));
            }
            return result;
        };
        const std::vector<StartPair> starts{{0, 1}, {1, 0}, {0, 1}};
        const auto alone = found(nullptr, starts);
        EXPECT_EQ(found(&shared, starts), alone);
        const std::size_t options = shared.option_count();
        EXPECT_GT(options, 0U);
        (void)found(&shared, {{0, 1}});
        EXPECT_LE(shared.option_count() - options, 2 * points.size()) << "those of the start alone";
    }
}

// Lemma 3, first case, does not hold as printed: the right boundary passes vertex 2 at more than 6.5 m, turns
// back beyond the end of the left one, and comes within 6.5 m of vertex 2 after all.
TEST(PathPairEnumeration, ABoundaryThatComesBackHealsWhatBothLeftBehind) {
    const std::vector<Point> points{{0.5, 1.9},    {0.3, -1.8},   {4.11, 3.9},   {7.02, 2.64},
                                    {2.76, -3.25}, {6.63, -2.21}, {10.58, 0.18}, {9.72, 2.98}};
    const PathPairVertices lane{{{0, 2, 3}, {1, 4, 5, 6, 7}}};
    EnumerationRules rules{.width_backtracking = WidthBacktracking::proven};
    EXPECT_EQ(open_pairs(enumerate(points, rules)).count(lane), 1u);
    rules.width_backtracking = WidthBacktracking::left_behind;
    EXPECT_EQ(open_pairs(enumerate(points, rules)).count(lane), 0u);
}

}  // namespace
}  // namespace conelane
