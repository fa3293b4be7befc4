#pragma once

#include "conelane/scene.hpp"
#include "evaluation/scoring/lane_iou.hpp"

#include <optional>
#include <span>
#include <vector>

/// The weak truth of a run without annotated boundaries: the driven path lies inside the lane.
namespace conelane {

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
