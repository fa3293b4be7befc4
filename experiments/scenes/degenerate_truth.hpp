#pragma once

#include "conelane/lane.hpp"
#include "conelane/scene.hpp"

namespace conelane::experiments {

/// A ground truth is degenerate below this share of the area that its length and width ask for.
inline constexpr double kDegenerateAreaShare = 0.5;

/// Whether a ground truth is no lane: the area between its boundaries, of clockwise turns, is less than
/// kDegenerateAreaShare of their mean length times the median distance of a cone to the other boundary.
/// Between legs of a course that are close to each other one boundary may go on beside another leg than its
/// own, far beyond the end of the other one. Precondition: all its cones are in the scene, two a side at
/// least.
[[nodiscard]] bool is_degenerate(const Lane& ground_truth, const Scene& scene);

}  // namespace conelane::experiments
