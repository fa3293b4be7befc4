#include "graph_search/front/front_detector.hpp"
#include "tests/support/counted_allocations.hpp"
#include "tests/support/front_fixture.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/random_scenes.hpp"

namespace conelane {
namespace {

TEST(FrontAllocations, OnlyTheAnswersBoundariesOnceMemoryIsWarm) {
    Scene scene = tests::straight_front_scene(10);
    for (const Cone& cone : tests::strewn_scene(60, 45.0, 40.0).cones)
        scene.cones.push_back({1000 + cone.id, cone.position});
    for (const FrontOptions& options : {shipped_front_options(), warm_front_options()}) {
        const auto detector = make_front_detector(options);
        const LaneAnswer first = detector->detect(scene, tests::kNoTimeLimit);
        ASSERT_EQ(first.status, LaneStatus::found);
        // The warm detector answers the second scene after the first, with other states.
        EXPECT_EQ(detector->detect(scene, tests::kNoTimeLimit).lane, first.lane);
        const std::size_t before = allocations;
        const LaneAnswer again = detector->detect(scene, tests::kNoTimeLimit);
        EXPECT_EQ(allocations - before, 2U);
        EXPECT_EQ(again.lane, first.lane);
    }
}

TEST(FrontAllocations, OnlyTheBoundaryThatIsSeenAlone) {
    Scene scene = tests::straight_front_scene(10);
    std::erase_if(scene.cones, [](const Cone& cone) { return cone.id >= 100; });
    const auto detector = make_front_detector(shipped_front_options());
    const LaneAnswer first = detector->detect(scene, tests::kNoTimeLimit);
    ASSERT_EQ(first.status, LaneStatus::found);
    ASSERT_EQ(first.lane.left.size(), 10U);
    const std::size_t before = allocations;
    const LaneAnswer again = detector->detect(scene, tests::kNoTimeLimit);
    EXPECT_EQ(allocations - before, 1U);
    EXPECT_EQ(again.lane, first.lane);
}

}  // namespace
}  // namespace conelane
