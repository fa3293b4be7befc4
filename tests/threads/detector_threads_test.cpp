// Detectors of the library in several threads at once, one instance each; also with the thread sanitizer.

#include "conelane/detectors.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/testing.hpp"

#include <thread>

namespace conelane {
namespace {

constexpr std::size_t kThreads = 4;

std::vector<Lane> lanes(const std::vector<Scene>& scenes, std::string_view detector_name) {
    const std::unique_ptr<LaneDetector> detector = make_detector(detector_name);
    std::vector<Lane> found;
    for (const Scene& scene : scenes) found.push_back(detector->detect(scene, tests::kNoTimeLimit).lane);
    return found;
}

TEST(DetectorThreads, FindWhatOneAloneFinds) {
    std::vector<Scene> scenes;
    for (std::uint64_t seed = 0; seed < 12; ++seed) scenes.push_back(tests::random_scene(seed, 18));
    for (const DetectorInfo& detector : detectors()) {
        SCOPED_TRACE(detector.name);
        std::vector<std::vector<Lane>> together(kThreads);
        {
            std::vector<std::jthread> threads;
            for (std::vector<Lane>& of_thread : together) {
                threads.emplace_back([&] { of_thread = lanes(scenes, detector.name); });
            }
        }
        const std::vector<Lane> alone = lanes(scenes, detector.name);
        for (const std::vector<Lane>& of_thread : together) EXPECT_EQ(of_thread, alone);
    }
}

}  // namespace
}  // namespace conelane
