// The limits of nearest cones: an edge joins a cone with one of its nearest. Builder, checker and the
// definition, counted by hand, agree.

#include "conelane/check.hpp"
#include "conelane/lane_graph_problem.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/learned_costs.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

using tests::cones_at;

/// The listed edge, if it may be chosen. Both extents and the checker have to agree on that.
std::optional<ProblemEdge> allowed(const Scene& scene, const RldParameters& parameters, std::size_t i,
                                   std::size_t j) {
    const auto find = [&](EdgeExtent extent) -> std::optional<ProblemEdge> {
        for (const ProblemEdge& edge : make_problem(scene, parameters, extent).edges) {
            if (edge.i == i && edge.j == j && !edge.high_cost) return edge;
        }
        return std::nullopt;
    };
    const auto edge = find(EdgeExtent::candidates);
    EXPECT_EQ(find(EdgeExtent::all_pairs).has_value(), edge.has_value());
    EXPECT_EQ(check(scene, parameters, {{{i, j}}}).is_final, !edge.has_value());
    return edge;
}

/// Cones at 0, 1, 2.5 and 4.5 m of a line. Seen from the first cone, the last one is the third nearest; seen
/// from the last cone, the first one is the third nearest, too.
TEST(NearestCones, AreCountedFromEitherEnd) {
    const Scene line = cones_at({{0.0, 0.0}, {1.0, 0.0}, {2.5, 0.0}, {4.5, 0.0}});
    RldParameters parameters;
    parameters.s_crit = 20.0;
    EXPECT_TRUE(allowed(line, parameters, 0, 3)) << "0 is no limit";
    parameters.nearest_of_edge = 3.0;
    EXPECT_TRUE(allowed(line, parameters, 0, 3));
    parameters.nearest_of_edge = 2.0;
    EXPECT_FALSE(allowed(line, parameters, 0, 3));
    EXPECT_TRUE(allowed(line, parameters, 0, 2));
    parameters.nearest_of_edge = 1.0;
    EXPECT_TRUE(allowed(line, parameters, 0, 1));
    EXPECT_TRUE(allowed(line, parameters, 1, 2)) << "1 is the nearest of 2, though 0 is nearer to 1 than 2";
    EXPECT_TRUE(allowed(line, parameters, 2, 3)) << "2 is the nearest of 3";
    EXPECT_FALSE(allowed(line, parameters, 0, 2));
    EXPECT_FALSE(allowed(line, parameters, 1, 3));
}

/// Cones at the same distance have the same rank.
TEST(NearestCones, AtTheSameDistanceAreAllAmongTheNearest) {
    const Scene star = cones_at({{0.0, 0.0}, {3.2, 0.0}, {0.0, 3.2}, {-3.2, 0.0}, {0.0, -3.2}});
    RldParameters parameters;
    parameters.nearest_of_edge = 1.0;
    for (std::size_t ray = 1; ray < star.cones.size(); ++ray) EXPECT_TRUE(allowed(star, parameters, 0, ray));
}

TEST(NearestCones, HaveALimitOfTheirOwnOverGaps) {
    const Scene row = cones_at({{-3.2, 0.0}, {0.0, 0.0}, {6.4, 0.0}, {9.6, 0.0}});
    RldParameters parameters;
    parameters.d_gap = 7.0;
    parameters.nearest_of_edge = 1.0;
    ASSERT_TRUE(allowed(row, parameters, 1, 2));
    EXPECT_TRUE(allowed(row, parameters, 1, 2)->gap);
    parameters.nearest_of_gap = 1.0;
    EXPECT_FALSE(allowed(row, parameters, 1, 2)) << "both have a nearer neighbour behind them";
    parameters.nearest_of_gap = 2.0;
    EXPECT_TRUE(allowed(row, parameters, 1, 2));
}

/// All edges of random scenes, by the definition: fewer than k cones nearer, at one end.
TEST(NearestCones, AreThoseOfTheDefinition) {
    int excluded = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene = tests::random_scene(seed, 14);
        RldParameters parameters;
        parameters.d_gap = 9.0;
        parameters.theta_gap = 0.7;
        const LaneGraphProblem unlimited = make_problem(scene, parameters);
        parameters.nearest_of_edge = static_cast<double>(1 + seed % 4);
        parameters.nearest_of_gap = static_cast<double>(2 + seed % 5);
        const LaneGraphProblem limited = make_problem(scene, parameters);
        const auto distance = [&](std::size_t a, std::size_t b) {
            return (scene.cones[a].position - scene.cones[b].position).norm();
        };
        const auto rank = [&](std::size_t from, std::size_t to) {
            std::size_t nearer = 0;
            for (std::size_t k = 0; k < scene.cones.size(); ++k)
                nearer += k != from && distance(from, k) < distance(from, to) ? 1 : 0;
            return static_cast<double>(nearer);
        };
        std::vector<Edge> expected;
        for (const ProblemEdge& edge : unlimited.edges) {
            const double k = edge.gap ? parameters.nearest_of_gap : parameters.nearest_of_edge;
            const bool kept = rank(edge.i, edge.j) < k || rank(edge.j, edge.i) < k;
            if (kept) expected.push_back({edge.i, edge.j});
            excluded += kept ? 0 : 1;
            EXPECT_EQ(check(scene, parameters, {{{edge.i, edge.j}}}).is_final, !kept);
        }
        std::vector<Edge> listed;
        for (const ProblemEdge& edge : limited.edges) listed.push_back({edge.i, edge.j});
        EXPECT_EQ(listed, expected);
    }
    EXPECT_GT(excluded, 100);
}

/// An excluded edge still faces others, so the costs of those that are left do not change.
TEST(NearestCones, ChangeNoCost) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene = tests::random_scene(seed, 12);
        RldParameters parameters;
        parameters.d_gap = 9.0;
        parameters.facing_weight = 0.7;
        parameters.learned_costs = tests::random_learned_costs(seed, 4);
        const LaneGraphProblem unlimited = make_problem(scene, parameters);
        parameters.nearest_of_edge = 3.0;
        parameters.nearest_of_gap = 4.0;
        const LaneGraphProblem limited = make_problem(scene, parameters);
        ASSERT_LT(limited.edges.size(), unlimited.edges.size());
        for (const ProblemEdge& edge : limited.edges) {
            const auto same = std::ranges::find_if(unlimited.edges, [&](const ProblemEdge& other) {
                return other.i == edge.i && other.j == edge.j;
            });
            EXPECT_EQ(edge.cost, same->cost);
        }
    }
}

}  // namespace
}  // namespace conelane
