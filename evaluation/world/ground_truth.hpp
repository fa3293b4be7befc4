#pragma once

#include "conelane/lane.hpp"
#include "conelane/scene.hpp"
#include "evaluation/world/annotated_scene.hpp"

#include <cstddef>
#include <optional>
#include <unordered_map>

namespace conelane {

/// The ground truth of the scene with only its `nearest` cones ahead (see cut_to_nearest). Nothing if a side
/// keeps fewer than two cones or the scene has no ground truth.
[[nodiscard]] std::optional<Lane> ground_truth_of_nearest(const AnnotatedScene& scene, std::size_t nearest);

/// The position of each cone in scene.cones by its id; only for look-up, its order is unspecified.
[[nodiscard]] inline std::unordered_map<ConeId, std::size_t> index_by_id(const Scene& scene) {
    std::unordered_map<ConeId, std::size_t> index_of;
    for (std::size_t i = 0; i < scene.cones.size(); ++i) index_of.emplace(scene.cones[i].id, i);
    return index_of;
}

/// A ground truth is degenerate below this share of the area that its length and width imply.
inline constexpr double kDegenerateAreaShare = 0.5;

/// Whether a ground truth is not a lane: the clockwise area between its boundaries is less than
/// kDegenerateAreaShare of their mean length times the median distance of a cone to the other boundary.
/// Between close legs of a course, one boundary may go on beside another leg, far beyond the end of the other
/// boundary. Precondition: all its cones are in the scene, at least two a side.
[[nodiscard]] bool is_degenerate(const Lane& ground_truth, const Scene& scene);

}  // namespace conelane
