// The limits of nearest cones: an edge joins a cone with one of its nearest. Builder, checker and the
// definition, counted by hand, agree.

#include "conelane/check.hpp"
#include "conelane/lane_graph_problem.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/learned_costs.hpp"
#include "tests/support/random_scenes.hpp"

namespace conelane {
namespace {

using tests::cones_at;

/// Cones at the same distance have the same rank.
TEST(NearestCones, AtTheSameDistanceAreAllAmongTheNearest) {
    const Scene star = cones_at({{0.0, 0.0}, {3.2, 0.0}, {0.0, 3.2}, {-3.2, 0.0}, {0.0, -3.2}});
    RldParameters parameters{.nearest_of_edge = 1.0};
    std::size_t rays = 0;
    for (const ProblemEdge& edge : make_problem(star, parameters).edges) rays += edge.i == 0 ? 1 : 0;
    EXPECT_EQ(rays, 4U);
    for (std::size_t ray = 1; ray < star.cones.size(); ++ray)
        EXPECT_FALSE(check(star, parameters, {{{0, ray}}}).is_final);
}

/// All edges of random scenes, by the definition: fewer than k cones nearer, at one end.
TEST(NearestCones, AreThoseOfTheDefinition) {
    int excluded = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene = tests::random_scene(seed, 14);
        RldParameters parameters{.d_gap = 9.0, .theta_gap = 0.7};
        const LaneGraphProblem unlimited = make_problem(scene, parameters);
        parameters.nearest_of_edge = static_cast<double>(1 + seed % 4);
        parameters.nearest_of_gap = static_cast<double>(2 + seed % 5);
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
        for (const EdgeExtent extent : {EdgeExtent::candidates, EdgeExtent::all_pairs}) {
            std::vector<Edge> allowed;
            for (const ProblemEdge& edge : make_problem(scene, parameters, extent).edges) {
                if (!edge.high_cost) allowed.push_back({edge.i, edge.j});
            }
            EXPECT_EQ(allowed, expected);
        }
    }
    EXPECT_GT(excluded, 100);
}

/// An excluded edge still faces others, so the costs of those that are left do not change.
TEST(NearestCones, ChangeNoCost) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene = tests::random_scene(seed, 12);
        RldParameters parameters{
            .facing_weight = 0.7, .d_gap = 9.0, .learned_costs = tests::random_learned_costs(seed, 4)};
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
