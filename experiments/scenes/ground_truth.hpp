#pragma once

#include "experiments/scenes/annotated_scene.hpp"
#include "model/lane.hpp"
#include "model/scene.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace conelane::experiments {

/// Widest lane [m]: beyond it one side of a ground truth has gone on alone.
inline constexpr double kWidestLane_m = 6.5;

/// Drops far ends until the last cone of each side is within kWidestLane_m of the polyline of the other side;
/// where both ends are too far, the left one goes first. A closed lane stays as it is, and so does a lane
/// with an empty side. Precondition: every id of the lane is a cone of the scene.
void even_far_ends(Lane& lane, const Scene& scene);

/// The ground truth of the scene that holds only its `nearest` cones ahead: each run is cut at its first cone
/// outside that set, then the far ends are evened. Nothing where a side keeps fewer than two cones or the
/// scene has no ground truth.
[[nodiscard]] std::optional<Lane> ground_truth_of_nearest(const AnnotatedScene& scene, std::size_t nearest);

}  // namespace conelane::experiments
