#pragma once

#include "evaluation/scoring/score.hpp"
#include "tests/support/testing.hpp"

namespace conelane {

inline constexpr double kLatency_ms = 3.0;

/// A straight lane along +x, cones every 4 m from x = 0 to 36: left ids 1..10, right ids 101..110. The car
/// stands 1 m before it.
inline AnnotatedScene straight_scene(double width_m = 3.5) {
    AnnotatedScene scene;
    scene.scene.id = "straight";
    scene.scene.pose.position = {-1, 0};
    Lane ground_truth;
    for (int i = 0; i < 10; ++i) {
        scene.scene.cones.push_back({.id = 1 + i, .position = {4.0 * i, width_m / 2}});
        scene.scene.cones.push_back({.id = 101 + i, .position = {4.0 * i, -width_m / 2}});
        ground_truth.left.push_back(1 + i);
        ground_truth.right.push_back(101 + i);
    }
    scene.ground_truth = ground_truth;
    return scene;
}

/// The boundaries of straight_scene() go on behind and ahead of what is visible.
inline const TrackBoundaries kTrack{{{-20, 1.75}, {80, 1.75}}, {{-20, -1.75}, {80, -1.75}}, false};

inline LaneAnswer found(Lane lane) {
    return LaneAnswer{.status = LaneStatus::found, .lane = std::move(lane)};
}

inline SceneScore scored(const AnnotatedScene& scene, const Lane& lane) {
    return score(scene, found(lane), kLatency_ms, std::nullopt, &kTrack);
}

inline void add_cone(AnnotatedScene& scene, ConeId id, const Point& position) {
    scene.scene.cones.push_back({.id = id, .position = position});
}

/// The ground truth with `id` on the left between the cones at x = 4 * (after - 1) and the next one.
inline Lane with_inserted(const AnnotatedScene& scene, int after, ConeId id) {
    Lane lane = *scene.ground_truth;
    lane.left.insert(lane.left.begin() + after, id);
    return lane;
}

inline Lane truncated(const AnnotatedScene& scene, std::size_t cones) {
    Lane lane = *scene.ground_truth;
    lane.left.resize(cones);
    lane.right.resize(cones);
    return lane;
}

}  // namespace conelane
