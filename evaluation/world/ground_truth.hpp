#pragma once

#include "conelane/lane.hpp"
#include "evaluation/world/annotated_scene.hpp"

#include <cstddef>
#include <optional>

namespace conelane {

/// The ground truth of the scene with only its `nearest` cones ahead (see cut_to_nearest). Nothing if a side
/// keeps fewer than two cones or the scene has no ground truth.
[[nodiscard]] std::optional<Lane> ground_truth_of_nearest(const AnnotatedScene& scene, std::size_t nearest);

}  // namespace conelane
