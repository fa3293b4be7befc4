#pragma once

#include "conelane/lane.hpp"
#include "conelane/scene.hpp"

namespace conelane {

/// A ground truth is degenerate below this share of the area that its length and width imply.
inline constexpr double kDegenerateAreaShare = 0.5;

/// Whether a ground truth is not a lane: the clockwise area between its boundaries is less than
/// kDegenerateAreaShare of their mean length times the median distance of a cone to the other boundary.
/// Between close legs of a course, one boundary may go on beside another leg, far beyond the end of the other
/// boundary. Precondition: all its cones are in the scene, at least two a side.
[[nodiscard]] bool is_degenerate(const Lane& ground_truth, const Scene& scene);

}  // namespace conelane
