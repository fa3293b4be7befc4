#include "graph_search/lane_consensus.hpp"

#include "graph_search/lane_features.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <gtest/gtest.h>

namespace conelane {
namespace {

/// All lanes of a map that start with its first two vertices.
struct Candidates {
    SearchGraph graph;
    PathPairs pairs;

    explicit Candidates(const std::vector<Point>& points) {
        graph.build(points, 5.5);
        SearchBudget budget;
        (void)PathPairEnumeration().run(graph, {0, 1}, {1.0, 0.0}, {}, budget, pairs);
    }
    [[nodiscard]] std::size_t size() const { return pairs.found().size(); }
    [[nodiscard]] std::size_t choose(const std::vector<double>& scores, std::size_t count) const {
        return LaneConsensus().choose(pairs, graph, scores, count);
    }
    /// The candidate with these vertices.
    [[nodiscard]] std::size_t place_of(const PathPairVertices& vertices) const {
        for (std::size_t i = 0; i < size(); ++i) {
            if (pairs.vertices(pairs.found()[i]) == vertices) return i;
        }
        ADD_FAILURE() << "no such candidate";
        return 0;
    }
};

/// A straight lane of `rows` pairs of cones, some metres apart, and `strewn` cones along it.
std::vector<Point> map(unsigned seed, int rows, int strewn) {
    boost::random::mt19937_64 random(seed);
    boost::random::uniform_real_distribution<> ahead(0.0, 4.0 * rows);
    boost::random::uniform_real_distribution<> across(-4.0, 4.0);
    std::vector<Point> points;
    for (int i = 0; i < rows; ++i) {
        points.emplace_back(1.0 + 4.0 * i, 2.0);
        points.emplace_back(1.2 + 4.0 * i, -2.0);
    }
    for (int i = 0; i < strewn; ++i) {
        const double x = ahead(random);
        points.emplace_back(x, across(random));
    }
    return points;
}

// Left 0, 2 and then 4 or 6, right 1, 3, 5. The lane over 6 has the highest score, but those over 4 and the
// ones that end before are together likelier.
TEST(LaneConsensus, LeavesALeaderThatGoesItsOwnWayAlone) {
    const Candidates candidates({{1, 2}, {1.2, -2}, {5, 2}, {5.2, -2}, {9, 2}, {9.2, -2}, {9, 3.2}});
    const std::size_t leader = candidates.place_of({{{0, 2, 6}, {1, 3, 5}}});
    const std::size_t whole = candidates.place_of({{{0, 2, 4}, {1, 3, 5}}});
    const std::size_t early = candidates.place_of({{{0, 2}, {1, 3, 5}}});
    std::vector<double> scores(candidates.size(), -50.0);
    scores[leader] = 1.0;
    scores[whole] = 0.7;
    scores[early] = 0.6;
    EXPECT_EQ(candidates.choose(scores, 1), leader);
    EXPECT_EQ(candidates.choose(scores, 24), early) << "strays from none";
    // Where the leader is surer, what the others agree on no longer counts.
    scores[leader] = 7.0;
    EXPECT_EQ(candidates.choose(scores, 24), leader);
}

TEST(LaneConsensus, WhatPartsBeyondTheNearPartStraysFromNothing) {
    std::vector<Point> points = map(0, 9, 0);
    points.emplace_back(points[16] + Point(0.0, 1.3));  // beside the last left one, 32 m ahead
    const Candidates candidates(points);
    PathPairVertices lane;
    for (Vertex vertex = 0; vertex < 18; ++vertex) lane[vertex % 2].push_back(vertex);
    const std::size_t right = candidates.place_of(lane);
    lane[kLeft].back() = 18;
    const std::size_t other = candidates.place_of(lane);
    lane[kLeft].pop_back();
    const std::size_t early = candidates.place_of(lane);
    std::vector<double> scores(candidates.size(), -50.0);
    scores[other] = 1.0;
    scores[right] = -1.0;
    scores[early] = -1.0;
    EXPECT_EQ(candidates.choose(scores, 24), other) << "no other is worth more than a cone less";
}

TEST(LaneConsensus, EqualsItsDefinition) {
    std::size_t other_than_leader = 0;
    for (unsigned seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(seed);
        const std::vector<Point> points = map(seed, 7, 8);
        const Candidates candidates(points);
        ASSERT_GT(candidates.size(), 40u);
        boost::random::mt19937_64 random(seed);
        boost::random::uniform_real_distribution<> any(0.0, 3.0);
        std::vector<double> scores;
        std::vector<std::size_t> order;
        for (std::size_t i = 0; i < candidates.size(); ++i) {
            order.push_back(i);
            scores.push_back(any(random));
        }
        constexpr std::size_t kCount = 20;
        std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return scores[a] > scores[b]; });
        order.resize(kCount);
        std::vector<PathPairVertices> lanes;
        for (const std::size_t i : order) {
            lanes.push_back(candidates.pairs.vertices(candidates.pairs.found()[i]));
        }
        std::size_t best = 0;
        double best_value = -std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < kCount; ++i) {
            double value = 0.0;
            for (std::size_t right = 0; right < kCount; ++right) {
                double shared = 0.0;
                double cones = 0.0;
                bool strays = false;
                for (const Side side : {kLeft, kRight}) {
                    const std::vector<Vertex>& lane = lanes[i][side];
                    double along_m = 0.0;
                    for (std::size_t k = 0; k < lane.size(); ++k) {
                        if (k > 0) along_m += (points[lane[k]] - points[lane[k - 1]]).norm();
                        const bool is_on = std::ranges::count(lanes[right][side], lane[k]) > 0;
                        shared += is_on ? 1.0 : 0.0;
                        strays = strays || (!is_on && along_m <= kNearPart_m);
                    }
                    cones += static_cast<double>(lane.size() + lanes[right][side].size());
                }
                value += std::exp(scores[order[right]]) *
                         (shared / (cones - shared) - (strays ? LaneConsensus::kStrayingPenalty : 0.0));
            }
            if (value > best_value) {
                best_value = value;
                best = order[i];
            }
        }
        EXPECT_EQ(candidates.choose(scores, kCount), best);
        EXPECT_EQ(candidates.choose(scores, 1), order.front());
        if (best != order.front()) ++other_than_leader;
    }
    EXPECT_GT(other_than_leader, 10u);
}

TEST(LaneConsensus, OfOneCandidateAndOfEqualOnesTakesTheFirst) {
    const Candidates candidates({{1, 2}, {1.2, -2}, {5, 2}, {5.2, -2}, {9, 2}, {9.2, -2}});
    ASSERT_GT(candidates.size(), 1u);
    std::vector<double> scores(candidates.size(), 0.0);
    EXPECT_EQ(candidates.choose(scores, 1), 0u);
    const Candidates single({{1, 2}, {1.2, -2}, {5, 2}, {5.2, -2}});
    ASSERT_EQ(single.size(), 1u);
    EXPECT_EQ(single.choose({-3.0}, 24), 0u);
}

}  // namespace
}  // namespace conelane
