#include "graph_search/clc/clc_detector.hpp"
#include "graph_search/weights/shipped_weights.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/counted_allocations.hpp"
#include "tests/support/no_time_limit.hpp"

namespace conelane {
namespace {

/// A lane of 15 cones a side among 30 false positives. It is straight, because a course that might be closed
/// is measured as a whole, which allocates.
std::vector<Point> points() {
    boost::random::mt19937_64 random(4);
    boost::random::uniform_real_distribution<> ahead(0.0, 50.0);
    boost::random::uniform_real_distribution<> across(-8.0, 8.0);
    std::vector<Point> all;
    for (int i = 0; i < 15; ++i) {
        all.emplace_back(1.0 + 3.5 * i, 1.9);
        all.emplace_back(0.8 + 3.5 * i, -1.8);
    }
    while (all.size() < 60) {
        const double x = ahead(random);
        all.emplace_back(x, across(random));
    }
    return all;
}

class EnumerationAllocations : public ::testing::TestWithParam<bool> {};

TEST_P(EnumerationAllocations, NoneOnceTheMemoryIsThere) {
    EnumerationRules rules{.with_features = GetParam()};
    SearchGraph graph;
    graph.build(points(), rules.d_max_m);
    PathPairEnumeration enumeration;
    PathPairs pairs;
    const auto search = [&](std::int64_t iteration_limit) {
        pairs.clear();
        SearchBudget budget;
        budget.iteration_limit = iteration_limit;
        const std::size_t before = allocations;
        (void)enumeration.run(graph, {0, 1}, {1.0, 0.0}, rules, budget, pairs);
        EXPECT_EQ(budget.iterations, iteration_limit);
        return allocations - before;
    };
    EXPECT_GT(search(20000), 0u) << "allocations are counted";
    EXPECT_GT(pairs.found().size(), 1000u);
    EXPECT_EQ(search(20000), 0u);
    EXPECT_EQ(search(2500), 0u);
}

TEST(BeamAllocations, NoneOnceTheMemoryIsThere) {
    Scene scene = tests::cones_at(points());
    SearchGraph graph;
    graph.build(points(), 5.5);
    const std::vector<StartPair> starts = start_pairs(scene, 100, {});
    const std::shared_ptr<const StepScores> scores = shipped_step_scores();
    LaneBeam beam;
    const auto search = [&] {
        const std::size_t before = allocations;
        beam.start(graph, scene, starts, *scores, {}, 8);
        SearchBudget budget;
        EXPECT_NE(beam.run(budget), LaneBeam::kNone);
        return allocations - before;
    };
    EXPECT_GT(search(), 0u) << "allocations are counted";
    EXPECT_EQ(search(), 0u);
}

TEST(DetectionAllocations, NoneButTheTwoBoundariesOnceTheMemoryIsThere) {
    Scene scene = tests::cones_at(points());
    ClcOptions warm_start = extended_clc_options();
    warm_start.warm_start = true;
    for (const ClcOptions& options :
         {extended_clc_options(), paper_clc_options(), ClcOptions{}, warm_start}) {
        const std::unique_ptr<LaneDetector> detector = make_clc_detector(options);
        const auto detect = [&] {
            const std::size_t before = allocations;
            const LaneAnswer answer = detector->detect(scene, tests::kNoTimeLimit);
            EXPECT_EQ(answer.status, LaneStatus::found);
            return allocations - before;
        };
        EXPECT_GT(detect(), 2u) << "allocations are counted";
        (void)detect();  // the first call with a warm start
        EXPECT_EQ(detect(), 2u);
        std::ranges::reverse(scene.cones);
        (void)detect();
        EXPECT_EQ(detect(), 2u);
        scene.pose.position.x() = -1.0;
        EXPECT_LE(detect(), 2u) << "another scene";
        scene.pose.position.x() = 0.0;
    }
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutFeatures, EnumerationAllocations, ::testing::Bool());

}  // namespace
}  // namespace conelane
