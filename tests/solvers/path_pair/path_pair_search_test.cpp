// The parts of path-pair's search that need no scene: its clock, queue of nodes, and multipliers.

#include "solvers/path_pair/search/node_ascent.hpp"
#include "tests/support/clocks/fake_search_clock.hpp"
#include "tests/support/testing.hpp"

namespace conelane::path_pair {
namespace {

TEST(PathPairSearchClock, ChecksAfterAFixedAmountOfWork) {
    tests::FakeSearchClock clock;
    EXPECT_FALSE(clock.out_of_time(30'000));
    EXPECT_FALSE(clock.tick(19'999));
    EXPECT_EQ(clock.looks(), 0);
    EXPECT_FALSE(clock.tick(1));
    EXPECT_EQ(clock.looks(), 1);
    EXPECT_FALSE(clock.out_of_time());
    EXPECT_EQ(clock.looks(), 2);
    EXPECT_EQ(clock.total_work(), 30'000) << "ticks are not part of the total";
}

TEST(PathPairSearchClock, StaysExpired) {
    tests::FakeSearchClock clock(2);
    EXPECT_FALSE(clock.out_of_time());
    EXPECT_FALSE(clock.expired());
    EXPECT_TRUE(clock.out_of_time());
    EXPECT_TRUE(clock.expired());
    EXPECT_TRUE(clock.out_of_time()) << "though the deadline says otherwise now";
    EXPECT_TRUE(clock.tick(1));
    EXPECT_TRUE(clock.out_of_time(1));
}

TEST(PathPairSearchClock, KeepsItsDeadline) {
    SearchClock clock{Deadline(0.0)};
    EXPECT_FALSE(clock.tick(1)) << "not looked at yet";
    EXPECT_TRUE(clock.out_of_time());
    SearchClock never;
    EXPECT_FALSE(never.out_of_time());
}

std::vector<double> bounds_in_order(NodeQueue& queue) {
    std::vector<double> bounds;
    while (!queue.empty()) {
        std::unique_ptr<Node> node = queue.take_next();
        bounds.push_back(node->bound);
        queue.give_back(std::move(node));
    }
    return bounds;
}

TEST(PathPairNodeQueue, TakesTheLowestBoundAndOfEqualOnesTheLast) {
    NodeQueue queue(100);
    EXPECT_EQ(queue.min_bound(), kUnreachable);
    std::vector<const Node*> added;
    for (const double bound : {-1.0, -3.0, -2.0, -3.0}) {
        Node& node = queue.add();
        node.bound = bound;
        added.push_back(&node);
    }
    EXPECT_EQ(queue.min_bound(), -3.0);
    std::unique_ptr<Node> first = queue.take_next();
    EXPECT_EQ(first.get(), added[3]);
    EXPECT_EQ(bounds_in_order(queue), (std::vector<double>{-3.0, -2.0, -1.0}));
}

TEST(PathPairNodeQueue, GoesDepthFirstWhereItIsFull) {
    NodeQueue queue(3);
    for (const double bound : {-3.0, -2.0, -1.0}) queue.add().bound = bound;
    EXPECT_EQ(bounds_in_order(queue), (std::vector<double>{-1.0, -3.0, -2.0}))
        << "the last one, until fewer are open";
}

TEST(PathPairNodeQueue, ClearedGivesTheSameNodesInTheSameOrder) {
    NodeQueue queue(100);
    std::vector<const Node*> first;
    for (int node = 0; node < 4; ++node) first.push_back(&queue.add());
    queue.give_back(queue.take_next());
    queue.clear();
    EXPECT_TRUE(queue.empty());
    std::vector<const Node*> again;
    for (int node = 0; node < 4; ++node) again.push_back(&queue.add());
    EXPECT_EQ(again, first);
}

/// Two walks that meet at cone 0, miss cone 1, pass cone 2 once and have one edge along the heading too few.
TEST(PathPairAscent, StepsAlongTheViolations) {
    Multipliers multipliers{{0.0, 0.5, 0.0}, {}, 0.0};
    const Usage usage{{2, 0, 1}, {}, 1};
    const std::vector<int> none_required(3, 0);
    Ascent ascent;
    ascent.restart(multipliers);
    EXPECT_TRUE(ascent.step(multipliers, usage, none_required, 0.6, 1.0));
    // |d|^2 = 3: heading, cone 0, and cone 1, whose multiplier may fall.
    EXPECT_DOUBLE_EQ(multipliers.heading, 0.2);
    EXPECT_DOUBLE_EQ(multipliers.cone[0], 0.2);
    EXPECT_DOUBLE_EQ(multipliers.cone[1], 0.3);
    EXPECT_EQ(multipliers.cone[2], 0.0);
}

TEST(PathPairAscent, HasNoStepWhereNothingIsViolated) {
    Multipliers multipliers{{0.0, 0.0}, {}, 0.0};
    const std::vector<int> none_required(2, 0);
    Ascent ascent;
    ascent.restart(multipliers);
    EXPECT_FALSE(ascent.step(multipliers, {{1, 0}, {}, 2}, none_required, 1.0, 1.0));
    EXPECT_EQ(multipliers.cone, (std::vector<double>{0.0, 0.0}));
}

TEST(PathPairMultiplierStages, RoundsSoThatNoArcGetsCheaper) {
    MultiplierStages stages(0.25);
    Multipliers multipliers{{0.3, 0.0}, {0.26}, 0.49};
    stages.round(multipliers);
    EXPECT_EQ(multipliers.cone, (std::vector<double>{0.5, 0.0}));
    EXPECT_EQ(multipliers.clique, (std::vector<double>{0.5}));
    EXPECT_EQ(multipliers.heading, 0.25);
    stages.keep();
    stages.add({{1.0, 1.0}, {}, 0.0});
    const std::vector<Multipliers> taken = stages.take();
    ASSERT_EQ(taken.size(), 2U);
    EXPECT_EQ(taken[0].cone, multipliers.cone);
    EXPECT_EQ(taken[1].cone, (std::vector<double>{1.0, 1.0}));
    EXPECT_TRUE(stages.take().empty());
}

}  // namespace
}  // namespace conelane::path_pair
