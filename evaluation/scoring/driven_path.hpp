#pragma once

#include "conelane/scene.hpp"
#include "evaluation/scoring/lane_iou.hpp"

#include <optional>
#include <span>
#include <vector>

/// The weak truth of a run without annotated boundaries: the path that was driven lies inside the lane.
namespace conelane {

/// A driven path shows that a lane goes on where a cone is seen this near to it [m].
inline constexpr double kConeBesideDriven_m = 5.0;
/// A scene whose driven path shows less of the way ahead does not count [m].
inline constexpr double kMinDriven_m = 5.0;
/// The car of a scene stands on the driven path, up to its pose error [m].
inline constexpr double kOffDriven_m = 3.0;

/// The stretch of the driven path ahead of the car, from its foot point on: up to where the path leaves the
/// half disc of `range_m`, or the last place with a visible cone within kConeBesideDriven_m. Where the path
/// passes the car several times, the nearest pass within 60 degrees of its heading counts. Empty where there
/// is none.
[[nodiscard]] std::vector<Point> driven_ahead(const Scene& scene, std::span<const Point> driven,
                                              std::optional<double> range_m);

/// Distance along `ahead` at which it leaves the lane [m]: where it crosses a boundary, or passes a vertex on
/// the wrong side. Nothing where it stays inside for as long as both go on.
[[nodiscard]] std::optional<double> driven_divergence_m(const LaneOutline& lane,
                                                        std::span<const Point> ahead);

}  // namespace conelane
