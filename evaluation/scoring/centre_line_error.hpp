#pragma once

#include "conelane/scene.hpp"
#include "evaluation/scoring/lane_iou.hpp"

#include <optional>
#include <span>
#include <vector>

namespace conelane {

/// The stretch of a centre line over which lateral errors are taken [m].
inline constexpr double kCentreLineStretch_m = 20.0;
/// Length of centre lines [m]: poses that are farther apart have nothing in common.
inline constexpr double kCentreLineLength_m = kCentreLineStretch_m + 5.0;
/// Distance at which the heading error is taken [m].
inline constexpr double kHeadingAt_m = 10.0;
/// The stretch over which the centre lines of consecutive poses are compared [m].
inline constexpr double kSteadyStretch_m = 15.0;
/// Centre lines of consecutive poses that are within this distance everywhere are steady [m].
inline constexpr double kSteady_m = 0.5;
inline constexpr double kCentreLineStep_m = 0.5;

struct CentreLinePoint {
    Point position;
    double heading_rad;
};
/// From the car's foot point on, a point every kCentreLineStep_m; empty if a lane has no centre line.
using CentreLine = std::vector<CentreLinePoint>;

/// The first `length_m` of the centre line of a lane as a car would drive it (see `drivable`). Empty if the
/// lane cannot be driven, or a boundary is empty: inferred boundaries are not scored.
[[nodiscard]] CentreLine centre_line_of(const LaneOutline& lane, const Pose& pose,
                                        double length_m = kCentreLineLength_m);

/// The same for a polyline: resampled, from the foot point of the car on.
[[nodiscard]] CentreLine centre_line_of(std::span<const Point> polyline, const Pose& pose,
                                        double length_m = kCentreLineLength_m);

/// Distance of a lane's centre line from the true one.
struct CentreLineError {
    std::vector<float> lateral_m;       ///< at each point of the first kCentreLineStretch_m that both cover
    std::optional<double> heading_rad;  ///< at kHeadingAt_m; absent if one of the lines ends before
};
[[nodiscard]] CentreLineError centre_line_error(std::span<const CentreLinePoint> lane,
                                                std::span<const CentreLinePoint> truth);

/// Whether the centre line of a pose agrees with that of the pose before: over the first kSteadyStretch_m in
/// common, none of its points is farther than kSteady_m from the earlier line. False if they have nothing in
/// common, for example if one is empty.
[[nodiscard]] bool is_steady(std::span<const CentreLinePoint> before, std::span<const CentreLinePoint> now);

}  // namespace conelane
