// What is in several threads at once finds what one thread alone finds; also with the thread sanitizer.

#include "conelane/detectors.hpp"
#include "graph_search/clc/clc_detector.hpp"
#include "solvers/core_entries.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/straight_lane.hpp"

#include <thread>

namespace conelane {
namespace {

/// Calls `find` alone and then in four threads at once; expects the same results, which it returns.
template <typename Find>
auto same_in_threads(const Find& find) {
    auto alone = find();
    std::vector<decltype(alone)> together(4);
    {
        std::vector<std::jthread> threads;
        for (auto& of_thread : together) threads.emplace_back([&] { of_thread = find(); });
    }
    for (const auto& of_thread : together) EXPECT_EQ(of_thread, alone);
    return alone;
}

std::vector<Scene> random_scenes(std::size_t cones) {
    std::vector<Scene> scenes;
    for (std::uint64_t seed = 0; seed < 12; ++seed) scenes.push_back(tests::random_scene(seed, cones));
    return scenes;
}

std::vector<Lane> lanes(LaneDetector& detector, const std::vector<Scene>& scenes) {
    return mapped(scenes,
                  [&](const Scene& scene) { return detector.detect(scene, tests::kNoTimeLimit).lane; });
}

/// The lane along the `count` nearest cones of a straight scene, which all threads share.
TEST(ThreadSafety, OfASharedScene) {
    const Scene scene = tests::straight_lane(20, 0.0);
    for (std::size_t count = 4; count < scene.cones.size(); ++count) {
        const Lane found = same_in_threads([&] {
            validate(scene);
            LaneGraph graph;
            for (std::size_t i = 0; i + 2 < count; ++i) graph.edges.push_back(make_edge(i, i + 2));
            return to_lane(graph, nearest_ahead(scene, count)).value_or(Lane{});
        });
        ASSERT_EQ(found.left.size() + found.right.size(), count);
    }
}

TEST(ThreadSafety, OfTheDetectorsOfTheLibrary) {
    const std::vector<Scene> scenes = random_scenes(18);
    for (const DetectorInfo& info : detectors()) {
        SCOPED_TRACE(info.name);
        (void)same_in_threads([&] { return lanes(*make_detector(info.name), scenes); });
    }
}

/// They share their ranking.
TEST(ThreadSafety, OfClcDetectorsThatAreMadeAtTheSameTime) {
    const std::vector<Scene> scenes = random_scenes(24);
    ClcOptions warm = extended_clc_options();
    warm.warm_start = true;
    for (const ClcOptions& options : {extended_clc_options(), paper_clc_options(), warm})
        (void)same_in_threads([&] { return lanes(*make_clc_detector(options), scenes); });
    const std::vector<Lane> found =
        same_in_threads([&] { return lanes(*make_clc_detector(extended_clc_options()), {scenes[1]}); });
    EXPECT_FALSE(found.front().left.empty());
}

TEST(ThreadSafety, OfTheSolversOfTheCore) {
    const auto solve_all = [](std::unique_ptr<RldSolver> solver, std::size_t cones) {
        std::vector<std::tuple<SolveStatus, std::optional<LaneGraph>, std::optional<double>, std::int64_t>>
            all;
        for (const Scene& scene : random_scenes(cones)) {
            const RldReport report = solver->solve(make_problem(scene, {}), {});
            all.emplace_back(report.status, report.lane_graph, report.objective, report.nodes);
        }
        return all;
    };
    (void)same_in_threads([&] { return solve_all(make_path_pair_solver(), 24); });
    (void)same_in_threads([&] { return solve_all(make_exhaustive_solver(), 7); });
}

}  // namespace
}  // namespace conelane
