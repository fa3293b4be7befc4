#pragma once

#include "conelane/scene.hpp"
#include "evaluation/scoring/lane_iou.hpp"
#include "evaluation/world/track.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

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

// The weak truth of a run without annotated boundaries: the driven path lies inside the lane.

/// A lane goes on as far as cones are seen within this distance of the driven path [m].
inline constexpr double kConeBesideDriven_m = 5.0;
/// A scene with a shorter driven path ahead does not count [m].
inline constexpr double kMinDriven_m = 5.0;
/// Distance of the car of a scene from the driven path, up to its pose error [m].
inline constexpr double kOffDriven_m = 3.0;

/// The driven path ahead of the car, from its foot point on: up to where the path leaves the half disc of
/// `range_m`, or the last place with a visible cone within kConeBesideDriven_m. If the path passes the car
/// several times, the nearest pass within 60 degrees of its heading counts. Empty if there is none.
[[nodiscard]] std::vector<Point> driven_ahead(const Scene& scene, std::span<const Point> driven,
                                              std::optional<double> range_m);

/// Distance along `ahead` at which it leaves the lane [m]: where it crosses a boundary, or passes a vertex on
/// the wrong side. Nothing if it stays inside as long as both exist.
[[nodiscard]] std::optional<double> driven_divergence_m(const LaneOutline& lane,
                                                        std::span<const Point> ahead);

}  // namespace conelane
