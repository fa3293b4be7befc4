// Edges of a problem that are near each other, compared with the distances of all pairs.

#include "model/near_edges.hpp"

#include "tests/support/cones_at.hpp"

namespace conelane {
namespace {

class RandomPoints {
  public:
    explicit RandomPoints(std::uint64_t seed) : random_(seed) {}

    /// On a grid, some segments touch, are parallel, overlap, or have no length.
    Point on_grid() { return Point(grid_(random_), grid_(random_)); }
    Point anywhere() { return {anywhere_(random_), anywhere_(random_)}; }

  private:
    boost::random::mt19937_64 random_;
    boost::random::uniform_int_distribution<int> grid_{-6, 6};
    boost::random::uniform_real_distribution<double> anywhere_{-6.0, 6.0};
};

bool closer_by_distance(const Segment& a, const Segment& b, double limit_m) {
    const SegmentDistance gap = segment_distance(a, b);
    return gap.distance_m < limit_m && !gap.between_ends;
}

TEST(ComeCloser, SaysWhatTheDistanceSays) {
    RandomPoints points(1);
    int closer = 0;
    int crossing = 0;
    for (int k = 0; k < 100'000; ++k) {
        const auto point = [&] { return k % 2 == 0 ? points.on_grid() : points.anywhere(); };
        const Segment a{point(), point()};
        const Segment b{point(), point()};
        const double limit_m = 0.5 * (k % 9) - kTieTolerance;
        const bool expected = closer_by_distance(a, b, limit_m);
        ASSERT_EQ(come_closer({a.from, a.to}, {b.from, b.to}, limit_m), expected) << k;
        ASSERT_EQ(come_closer({b.from, b.to}, {a.to, a.from}, limit_m), expected) << k;
        closer += expected ? 1 : 0;
        crossing += expected && segments_cross(a, b) ? 1 : 0;
    }
    EXPECT_GT(closer, 30'000);
    EXPECT_LT(closer, 70'000);
    EXPECT_GT(crossing, 10'000);
}

/// Edges 0 - 1 and 2 - 3 across a lane 4 m wide, and 4 - 5 behind.
Scene three_edges() {
    return tests::cones_at({{0, 2}, {3, 2}, {0, -2}, {3, -2}, {-7, 2}, {-4, 2}});
}

std::vector<ProblemEdge> edges_between(const std::vector<std::pair<std::size_t, std::size_t>>& cones) {
    std::vector<ProblemEdge> edges;
    for (const auto& [i, j] : cones) {
        edges.emplace_back();
        edges.back().i = i;
        edges.back().j = j;
    }
    return edges;
}

TEST(NearEdges, AreThoseThatReachEachOther) {
    const Scene scene = three_edges();
    const std::vector<ProblemEdge> edges = edges_between({{0, 1}, {2, 3}, {4, 5}});
    NearEdges wide(scene, edges, 4.1);
    EXPECT_THAT(wide.after(0), ElementsAre(1, 2));
    EXPECT_THAT(wide.after(1), ElementsAre(2)) << "5.7 m away, but less than 4.1 m behind and to the left";
    EXPECT_THAT(wide.after(2), IsEmpty());
    NearEdges narrow(scene, edges, 3.9);
    EXPECT_THAT(narrow.after(0), IsEmpty()) << "one is too far to the right, one behind";
}

TEST(NearEdges, ShareNoCone) {
    const Scene scene = three_edges();
    const std::vector<ProblemEdge> edges = edges_between({{0, 1}, {0, 2}, {0, 3}, {1, 3}, {2, 3}});
    NearEdges near_edges(scene, edges, 10.0);
    EXPECT_THAT(near_edges.after(0), ElementsAre(4));
    EXPECT_THAT(near_edges.after(1), ElementsAre(3));
    EXPECT_THAT(near_edges.after(2), IsEmpty());
}

// Every pair within reach or crossing is found, and far fewer pairs than all are examined.
TEST(NearEdges, IncludeAllThatComeCloserOrCross) {
    RandomPoints points(2);
    std::size_t pairs = 0;
    std::size_t looked_at = 0;
    std::size_t conflicts = 0;
    for (int k = 0; k < 300; ++k) {
        Scene scene;
        for (ConeId id = 0; id < 14; ++id)
            scene.cones.push_back({id, k % 3 == 0 ? points.on_grid() : Point(2.0 * points.anywhere())});
        std::vector<std::pair<std::size_t, std::size_t>> cones;
        for (std::size_t i = 0; i < scene.cones.size(); ++i) {
            for (std::size_t j = i + 1; j < scene.cones.size(); ++j) {
                const double length_m = (scene.cones[i].position - scene.cones[j].position).norm();
                if (k % 2 == 0 || length_m < 6.0) cones.emplace_back(i, j);
            }
        }
        const std::vector<ProblemEdge> edges = edges_between(cones);
        const double reach_m = k % 4 - kTieTolerance;
        const auto segment = [&](std::size_t e) {
            return Segment{scene.cones[edges[e].i].position, scene.cones[edges[e].j].position};
        };
        NearEdges near_edges(scene, edges, reach_m);
        for (std::size_t e = 0; e < edges.size(); ++e) {
            const auto near = near_edges.after(e);
            ASSERT_TRUE(std::ranges::is_sorted(near));
            looked_at += near.size();
            for (std::size_t other = e + 1; other < edges.size(); ++other) {
                const bool shares_cone = edges[e].i == edges[other].i || edges[e].j == edges[other].i ||
                                         edges[e].j == edges[other].j;
                const bool found = std::ranges::binary_search(near, other);
                ++pairs;
                ASSERT_FALSE(found && shares_cone);
                if (shares_cone || (!closer_by_distance(segment(e), segment(other), reach_m) &&
                                    !segments_cross(segment(e), segment(other)))) {
                    continue;
                }
                ASSERT_TRUE(found) << k << ": " << e << ", " << other;
                ++conflicts;
            }
        }
    }
    EXPECT_GT(conflicts, 50'000U);
    EXPECT_LT(looked_at, pairs / 2);
}

}  // namespace
}  // namespace conelane
