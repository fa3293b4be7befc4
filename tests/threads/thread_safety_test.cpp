#include "conelane/lane_graph.hpp"
#include "conelane/scene.hpp"
#include "tests/support/testing.hpp"

#include <thread>

namespace conelane {
namespace {

constexpr std::size_t kThreads = 4;

/// Cones 0, 2, 4, ... on the left of a straight lane and 1, 3, 5, ... on its right, 4 m apart.
Scene straight(std::size_t cones_a_side) {
    Scene scene;
    for (std::size_t i = 0; i < cones_a_side; ++i) {
        const double along_m = 2.0 + 4.0 * static_cast<double>(i);
        scene.cones.push_back({static_cast<ConeId>(2 * i), {along_m, 1.5}});
        scene.cones.push_back({static_cast<ConeId>(2 * i + 1), {along_m, -1.5}});
    }
    return scene;
}

/// The lane along the `count` nearest cones of a straight scene.
Lane nearest_lane(const Scene& scene, std::size_t count) {
    validate(scene);
    LaneGraph graph;
    for (std::size_t i = 0; i + 2 < count; ++i) {
        graph.edges.push_back(make_edge(i, i + 2));
    }
    return to_lane(graph, nearest_ahead(scene, count)).value_or(Lane{});
}

TEST(ThreadSafety, ThreadsThatShareASceneFindWhatOneThreadFinds) {
    const Scene scene = straight(20);
    std::vector<Lane> alone(scene.cones.size());
    for (std::size_t count = 4; count < alone.size(); ++count) {
        alone[count] = nearest_lane(scene, count);
        ASSERT_EQ(alone[count].left.size() + alone[count].right.size(), count);
    }

    std::vector<std::vector<Lane>> together(kThreads, std::vector<Lane>(alone.size()));
    {
        std::vector<std::jthread> threads;
        for (std::vector<Lane>& lanes : together) {
            threads.emplace_back([&scene, &lanes] {
                for (std::size_t count = 4; count < lanes.size(); ++count) {
                    lanes[count] = nearest_lane(scene, count);
                }
            });
        }
    }
    for (const std::vector<Lane>& lanes : together) EXPECT_EQ(lanes, alone);
}

}  // namespace
}  // namespace conelane
