#include "graph_search/lane_neighbourhood.hpp"

#include <algorithm>
#include <cstddef>
#include <set>
#include <utility>
#include <vector>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace conelane {
namespace {

using ::testing::Contains;
using ::testing::Not;
using Boundary = std::vector<Vertex>;
using Lanes = std::set<std::pair<Boundary, Boundary>>;

struct Search {
    SearchGraph graph;
    EnumerationRules rules;
    SearchBudget budget;
    PathPairs pairs;
    LaneNeighbourhood neighbourhood;

    explicit Search(const std::vector<Point>& points) {
        rules.width_backtracking = WidthBacktracking::proven;
        rules.with_features = true;
        budget.iteration_limit = 1'000'000;
        graph.build(points, rules.d_max_m);
    }
    Lanes around(const PathPairVertices& lane, const PathPairVertices& starts = {}) {
        pairs.clear();
        neighbourhood.run(graph, lane, starts, {1.0, 0.0}, rules, budget, pairs);
        Lanes lanes;
        for (const PathPair& pair : pairs.found()) {
            const PathPairVertices vertices = pairs.vertices(pair);
            lanes.emplace(vertices[kLeft], vertices[kRight]);
            EXPECT_EQ(pairs.start(pair), (StartPair{vertices[kLeft][0], vertices[kRight][0]}));
        }
        EXPECT_EQ(pairs.features().size(), pairs.found().size());
        return lanes;
    }
};

TEST(LaneNeighbourhood, ChangesOneBoundaryInOnePlace) {
    // Left 0, 2, 4, 6, right 1, 3, 5, 7; cone 8 stands off the left boundary between 2 and 4.
    const std::vector<Point> points{{0, 2},  {0, -2}, {4, 2},   {4, -2}, {8, 2},
                                    {8, -2}, {12, 2}, {12, -2}, {6, 3.4}};
    const Lanes lanes = Search(points).around({Boundary{0, 2, 8, 4, 6}, Boundary{1, 3, 5, 7}});
    const Boundary right{1, 3, 5, 7};
    EXPECT_THAT(lanes, Contains(std::pair(Boundary{0, 2, 4, 6}, right))) << "one left out";
    EXPECT_THAT(lanes, Contains(std::pair(Boundary{2, 8, 4, 6}, right))) << "another start";
    EXPECT_THAT(lanes, Contains(std::pair(Boundary{0, 2, 8, 4}, right))) << "the end left out";
    EXPECT_THAT(lanes, Not(Contains(std::pair(Boundary{0, 2, 8, 4, 6}, right)))) << "the lane itself";
    EXPECT_THAT(lanes, Not(Contains(std::pair(Boundary{0, 2, 4, 6}, Boundary{1, 3, 5})))) << "two changes";

    const Lanes around_right = Search(points).around({Boundary{0, 2, 4, 6}, right});
    EXPECT_THAT(around_right, Contains(std::pair(Boundary{0, 2, 8, 4, 6}, right))) << "a cone put in";
    EXPECT_THAT(around_right, Contains(std::pair(Boundary{0, 8, 4, 6}, right)).Times(0))
        << "0 and 8 are farther apart than d_max";
}

TEST(LaneNeighbourhood, LeavesTheFarPartAlone) {
    std::vector<Point> points;
    Boundary left;
    Boundary right;
    for (Vertex i = 0; i < 12; ++i) {
        points.emplace_back(2.5 * i, 2.0);
        points.emplace_back(2.5 * i, -2.0);
        left.push_back(2 * i);
        right.push_back(2 * i + 1);
    }
    const Lanes lanes = Search(points).around({left, right});
    const auto without = [&](std::size_t place) {
        Boundary rest = left;
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(place));
        return std::pair(rest, right);
    };
    // A detour leaves at the vertex before: at 22.5 m from the first one, at 25 m.
    EXPECT_THAT(lanes, Contains(without(10)));
    EXPECT_THAT(lanes, Not(Contains(without(11))));
}

/// The lanes that the class promises, one by one, each held against the definition of the constraints.
Lanes by_definition(const SearchGraph& graph, const PathPairVertices& lane, const PathPairVertices& starts) {
    Lanes lanes;
    const auto points = [&](const Boundary& boundary) {
        std::vector<Point> result;
        for (const Vertex vertex : boundary) result.push_back(graph.position(vertex));
        return result;
    };
    const auto on_lane = [&](Vertex vertex) {
        return std::ranges::any_of(lane, [&](const Boundary& boundary) {
            return std::ranges::find(boundary, vertex) != boundary.end();
        });
    };
    for (const Side side : {kLeft, kRight}) {
        const Boundary& boundary = lane[side];
        const auto add = [&](Boundary changed, std::size_t to) {
            for (std::size_t i = to; i < boundary.size(); ++i) changed.push_back(boundary[i]);
            if (changed.size() < 2) return;
            for (std::size_t i = 1; i < changed.size(); ++i) {
                if (!graph.adjacent(changed[i - 1], changed[i])) return;
            }
            PathPairVertices all = lane;
            all[side] = changed;
            if (satisfies_constraints(points(all[kLeft]), points(all[kRight]), {})) {
                lanes.emplace(all[kLeft], all[kRight]);
            }
        };
        double along_m = 0.0;
        for (std::size_t at = 0; at < boundary.size(); ++at) {
            if (at > 0) along_m += (graph.position(boundary[at]) - graph.position(boundary[at - 1])).norm();
            if (along_m > kDetourRange_m) break;
            const Boundary kept(boundary.begin(), boundary.begin() + static_cast<std::ptrdiff_t>(at) + 1);
            for (std::size_t to = at + 1; to <= std::min(at + 1 + kMostLeftOut, boundary.size()); ++to) {
                if (to > at + 1) add(kept, to);
                for (Vertex via = 0; via < graph.vertex_count(); ++via) {
                    if (on_lane(via)) continue;
                    Boundary over = kept;
                    over.push_back(via);
                    add(over, to);
                }
            }
        }
        add({}, 1);
        for (const Vertex vertex : starts[side]) {
            if (on_lane(vertex)) continue;
            for (std::size_t to = 0; to <= kMostLeftOut; ++to) add({vertex}, to);
        }
    }
    return lanes;
}

TEST(LaneNeighbourhood, IsAllThatItsDefinitionNamesAndNothingElse) {
    std::size_t found = 0;
    for (unsigned seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(seed);
        boost::random::mt19937_64 random(seed);
        boost::random::uniform_real_distribution<> ahead(0.0, 22.0);
        boost::random::uniform_real_distribution<> across(-4.5, 4.5);
        std::vector<Point> points;
        PathPairVertices lane;
        for (Vertex i = 0; i < 6; ++i) {
            points.emplace_back(0.5 + 3.6 * i, 2.1 + across(random) / 10.0);
            points.emplace_back(0.3 + 3.6 * i, -2.1 + across(random) / 10.0);
            lane[kLeft].push_back(2 * i);
            lane[kRight].push_back(2 * i + 1);
        }
        PathPairVertices starts;
        while (points.size() < 26) {
            const double x = ahead(random);
            points.emplace_back(x, across(random));
            if (x < 6.0) {
                starts[points.back().y() > 0.0 ? kLeft : kRight].push_back(
                    static_cast<Vertex>(points.size() - 1));
            }
        }
        Search search(points);
        const Lanes lanes = search.around(lane, starts);
        EXPECT_EQ(lanes, by_definition(search.graph, lane, starts));
        found += lanes.size();
    }
    EXPECT_GT(found, 1000u);
}

TEST(LaneNeighbourhood, KeepsToItsBudget) {
    std::vector<Point> points;
    PathPairVertices lane;
    for (Vertex i = 0; i < 6; ++i) {
        points.emplace_back(3.0 * i, 2.0);
        points.emplace_back(3.0 * i, -2.0);
        lane[kLeft].push_back(2 * i);
        lane[kRight].push_back(2 * i + 1);
    }
    Search search(points);
    const Lanes all = search.around(lane);
    const std::int64_t needed = search.budget.iterations;
    for (std::int64_t limit = 0; limit < needed; limit += 7) {
        search.budget = {};
        search.budget.iteration_limit = limit;
        const Lanes some = search.around(lane);
        EXPECT_EQ(search.budget.iterations, limit);
        EXPECT_TRUE(std::ranges::includes(all, some));
    }
}

}  // namespace
}  // namespace conelane
