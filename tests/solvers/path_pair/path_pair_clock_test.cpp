// The work of path-pair before its first bound takes milliseconds in a dense scene. So the clock is checked
// throughout, and the time may end at any check.

#include "solvers/path_pair/graph/block_rows.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "tests/support/clocks/fake_search_clock.hpp"
#include "tests/support/near_to_far.hpp"
#include "tests/support/testing.hpp"

namespace conelane::path_pair {
namespace {

/// A grid of 12 by 16 cones, 1.9 m apart: 2700 edges.
LaneGraphProblem dense_problem() {
    Scene scene;
    for (int row = 0; row < 12; ++row) {
        for (int column = 0; column < 16; ++column) {
            const auto id = static_cast<ConeId>(scene.cones.size());
            scene.cones.push_back({id, Point(1.9 * column, 1.9 * (row - 5.5) + 0.01 * column)});
        }
    }
    return make_problem(scene, {});
}

TEST(PathPairClock, IsCheckedWhileTheArcGraphIsMade) {
    const LaneGraphProblem problem = dense_problem();
    ASSERT_GT(problem.edges.size(), 1500U);
    tests::FakeSearchClock clock;
    ArcGraph graph;
    EXPECT_TRUE(graph.build(problem, clock));
    const int looks = clock.looks();
    // At least this number of steps of a nanosecond, with a check after each 50 000 of them.
    EXPECT_GT(looks, static_cast<int>((10 * problem.conflicts.size() + 20 * problem.turns.size()) / 50'000));

    for (int last = 1; last <= looks; ++last) {
        tests::FakeSearchClock striking(last);
        EXPECT_FALSE(graph.build(problem, striking)) << "look " << last << " of " << looks;
        EXPECT_EQ(striking.looks(), last);
    }
}

TEST(PathPairClock, IsCheckedWhileTheResidualGraphIsMade) {
    const LaneGraphProblem problem = dense_problem();
    SearchClock no_limit;
    ArcGraph graph;
    ASSERT_TRUE(graph.build(problem, no_limit));
    const std::vector<char> near = tests::near_to_far(graph).kinds[0].start;
    tests::FakeSearchClock clock;
    ResidualGraph whole;
    EXPECT_TRUE(whole.assign(graph, near, clock));
    const int looks = clock.looks();
    EXPECT_EQ(whole.in_arc.size(), whole.out_arc.size());
    EXPECT_GT(looks, static_cast<int>(10 * whole.out_arc.size() / 50'000));

    for (int last = 1; last <= looks; ++last) {
        tests::FakeSearchClock striking(last);
        ResidualGraph part;
        EXPECT_FALSE(part.assign(graph, near, striking)) << "look " << last << " of " << looks;
        EXPECT_EQ(part.size(), 0);
        EXPECT_EQ(part.out_start, std::vector<int>{0});
    }
}

TEST(PathPairClock, IsCheckedWhileAVectorIsFilled) {
    constexpr std::size_t kCount = 300'000;
    tests::FakeSearchClock clock;
    std::vector<int> values{1, 2};
    EXPECT_TRUE(fill(values, kCount, 7, clock));
    EXPECT_EQ(values.size(), kCount);
    EXPECT_THAT(values, testing::Each(7));
    EXPECT_GT(clock.looks(), 5);

    tests::FakeSearchClock striking(3);
    EXPECT_FALSE(fill(values, kCount, 8, striking));
    EXPECT_LT(values.size(), kCount);
    EXPECT_EQ(striking.looks(), 3);
}

TEST(PathPairClock, IsCheckedWhileAVectorGrows) {
    std::vector<int> values;
    for (int i = 0; i < 300'000; ++i) values.push_back(i);
    values.shrink_to_fit();
    const std::vector<int> before = values;

    tests::FakeSearchClock striking(3);
    EXPECT_FALSE(make_room(values, 1, striking));
    EXPECT_EQ(values, before) << "nothing is lost";
    EXPECT_EQ(values.capacity(), before.size());

    tests::FakeSearchClock clock;
    EXPECT_TRUE(make_room(values, 1, clock));
    EXPECT_EQ(values, before);
    EXPECT_GE(values.capacity(), 2 * before.size());
    const int looks = clock.looks();
    EXPECT_GT(looks, 5);
    EXPECT_TRUE(make_room(values, 100, clock));
    EXPECT_EQ(clock.looks(), looks) << "there is room";
}

/// A limit in steps, unlike a limit of time, ends a search at the same place each time.
TEST(PathPairWork, ALimitOfWorkEndsTheSearchInTheSamePlace) {
    const LaneGraphProblem problem = dense_problem();
    std::vector<RldReport> reports;
    for (const std::int64_t work : {20'000'000, 20'000'000, 60'000'000})
        reports.push_back(make_path_pair_solver({.max_work = work})->solve(problem, {}));
    for (const RldReport& report : reports) {
        EXPECT_NE(report.status, SolveStatus::optimal);
        EXPECT_EQ(report.stopped_by, StopReason::time);
    }
    EXPECT_EQ(reports[0].lane_graph, reports[1].lane_graph);
    EXPECT_EQ(reports[0].objective, reports[1].objective);
    EXPECT_EQ(reports[0].bound, reports[1].bound);
    EXPECT_EQ(reports[0].nodes, reports[1].nodes);
    ASSERT_TRUE(reports[0].bound && reports[2].bound);
    EXPECT_LE(*reports[0].bound, *reports[2].bound);
}

}  // namespace
}  // namespace conelane::path_pair
