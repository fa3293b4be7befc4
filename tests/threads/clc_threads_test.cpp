// One detector in each thread, all at once; also with the thread sanitizer.

#include "graph_search/clc/clc_detector.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/testing.hpp"

#include <thread>

namespace conelane {
namespace {

constexpr std::size_t kThreads = 4;

std::vector<Lane> lanes(const std::vector<Scene>& scenes, const ClcOptions& options) {
    const std::unique_ptr<LaneDetector> detector = make_clc_detector(options);
    std::vector<Lane> found;
    for (const Scene& scene : scenes) found.push_back(detector->detect(scene, tests::kNoTimeLimit).lane);
    return found;
}

TEST(ClcThreads, DetectorsThatShareARankingFindWhatOneAloneFinds) {
    std::vector<Scene> scenes;
    for (std::uint64_t seed = 0; seed < 12; ++seed) scenes.push_back(tests::random_scene(seed, 24));
    ClcOptions warm = extended_clc_options();
    warm.warm_start = true;
    for (const ClcOptions& options : {extended_clc_options(), paper_clc_options(), warm}) {
        const std::vector<Lane> alone = lanes(scenes, options);
        std::vector<std::vector<Lane>> together(kThreads);
        {
            std::vector<std::jthread> threads;
            for (std::vector<Lane>& of_thread : together) {
                threads.emplace_back([&] { of_thread = lanes(scenes, options); });
            }
        }
        for (const std::vector<Lane>& of_thread : together) EXPECT_EQ(of_thread, alone);
    }
}

TEST(ClcThreads, DetectorsAreMadeAtTheSameTime) {
    const Scene scene = tests::random_scene(1, 24);
    std::vector<Lane> together(kThreads);
    {
        std::vector<std::jthread> threads;
        for (Lane& lane : together) {
            threads.emplace_back([&] { lane = lanes({scene}, extended_clc_options()).front(); });
        }
    }
    for (const Lane& lane : together) EXPECT_EQ(lane, together.front());
    EXPECT_FALSE(together.front().left.empty());
}

}  // namespace
}  // namespace conelane
