#pragma once

#include "conelane/scene.hpp"
#include "evaluation/scoring/lane_iou.hpp"
#include "evaluation/world/track.hpp"

#include <cstddef>
#include <optional>
#include <span>

namespace conelane {

/// A vertex farther from its annotated boundary than this is off [m].
inline constexpr double kOffBoundary_m = 1.0;
/// The foot point of a vertex may move along the boundary by -2 m to twice the chord + 3 m.
inline constexpr double kFootBack_m = 2.0;
inline constexpr double kFootPerChord = 2.0;
inline constexpr double kFootAhead_m = 3.0;
/// The foot point of the first vertex may be -8 m to 12 m from the first ground-truth cone.
inline constexpr double kFirstFootBack_m = 8.0;
inline constexpr double kFirstFootAhead_m = 12.0;

/// Where one predicted boundary leaves the annotated one.
struct BoundaryDivergence {
    double distance_m;       ///< the divergence distance
    std::size_t vertex_off;  ///< index of the first vertex that is off
};

/// The first vertex of one predicted boundary that is off; nothing if none is.
///
/// Walks `predicted` outward. A vertex is off if it is more than kOffBoundary_m from the whole `annotated`
/// polyline, or if its foot point there leaps along the polyline; the limits themselves are not off. On a
/// closed boundary a foot point has no unique position: the first one past the lower limit is taken, so
/// passing the seam and driving several rounds are not leaps. The distance runs along the boundary from the
/// foot of `first_ground_truth_cone` to that of the last vertex before the first one off; 0 if there is no
/// such vertex or it is behind that cone.
/// Throws InvalidInput if `annotated` has no vertex and `predicted` has one.
[[nodiscard]] std::optional<BoundaryDivergence> boundary_divergence(std::span<const Point> predicted,
                                                                    std::span<const Point> annotated,
                                                                    bool closed,
                                                                    const Point& first_ground_truth_cone);
/// Only the divergence distance.
[[nodiscard]] std::optional<double> boundary_divergence_m(std::span<const Point> predicted,
                                                          std::span<const Point> annotated, bool closed,
                                                          const Point& first_ground_truth_cone);

/// Divergence distance [m] of a lane: the smaller one of the sides that are off; nothing if neither is. Each
/// side is compared only with the annotated boundary of that side, so a lane with swapped sides diverges at
/// 0. It does not matter whether the lane is closed.
/// Precondition: both sides of `ground_truth` have a vertex.
[[nodiscard]] std::optional<double> divergence_m(const LaneOutline& predicted,
                                                 const LaneOutline& ground_truth,
                                                 const TrackBoundaries& annotated);

}  // namespace conelane
