// The memory of the process does not grow with the calls of a detector or solver.

#include "conelane/detectors.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "solvers/registry.hpp"
#include "tests/support/testing.hpp"

#include <malloc.h>

namespace conelane {
namespace {

/// Allocated and not freed.
std::size_t heap_bytes() {
    const struct mallinfo2 heap = mallinfo2();
    return heap.uordblks + heap.hblkhd;
}

/// Growth of the heap in the second half of the calls, in turn on all scenes; the first fills workspaces.
std::ptrdiff_t growth_bytes(const std::vector<AnnotatedScene>& scenes, std::size_t calls,
                            const std::function<void(const Scene&)>& call) {
    std::size_t middle_bytes = 0;
    for (std::size_t k = 0; k < calls; ++k) {
        if (k == calls / 2) middle_bytes = heap_bytes();
        call(scenes[k % scenes.size()].scene);
    }
    return static_cast<std::ptrdiff_t>(heap_bytes() - middle_bytes);
}

/// CONELANE_MEMORY_CALLS=100000 makes more calls.
TEST(Memory, DoesNotGrowWithTheCalls) {
    SceneOptions options{.false_positive_rates = {0.2}, .ranges_m = {20.0}, .every_m = 60.0};
    const std::vector<AnnotatedScene> scenes = make_scene_set({"generated:kidney"}, options).scenes;
    const char* const asked = std::getenv("CONELANE_MEMORY_CALLS");
    const std::size_t calls = asked == nullptr ? 2000 : std::stoul(asked);
    // Even the smallest leak in every fourth call would exceed the blocks that the allocator holds back.
    const auto most_bytes = static_cast<std::ptrdiff_t>(4 * calls);
    for (const char* const name : {"front", "clc"}) {
        const std::unique_ptr<LaneDetector> detector = make_detector(name);
        const auto grown = growth_bytes(scenes, calls, [&](const Scene& scene) {
            EXPECT_NE(detector->detect(scene, {}).status, LaneStatus::error);
        });
        EXPECT_LT(grown, most_bytes) << name;
    }
    const std::unique_ptr<RldSolver> solver = find_rld_solver("path-pair")->make(Formulation::tight);
    const auto solve = [&](const Scene& scene) {
        EXPECT_NE(solve_scene(*solver, scene, {}, {}).report.status, SolveStatus::error);
    };
    EXPECT_LT(growth_bytes(scenes, calls, solve), most_bytes);
    std::vector<std::vector<char>> kept;
    const auto leak = [&](const Scene&) { kept.emplace_back(1000, 'x'); };
    EXPECT_GT(growth_bytes(scenes, calls, leak), most_bytes) << "the test sees what is not freed";
}

}  // namespace
}  // namespace conelane
