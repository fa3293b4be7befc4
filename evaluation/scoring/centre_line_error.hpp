#pragma once

#include "conelane/scene.hpp"
#include "evaluation/scoring/lane_iou.hpp"

#include <optional>
#include <span>
#include <vector>

namespace conelane {

/// The stretch of a centre line over which lateral errors are taken [m].
inline constexpr double kCentreLineStretch_m = 20.0;
/// How long centre lines are [m]: poses that are farther apart have nothing in common.
inline constexpr double kCentreLineLength_m = kCentreLineStretch_m + 5.0;
/// Where the heading error is taken [m].
inline constexpr double kHeadingAt_m = 10.0;
/// The stretch over which the centre lines of consecutive poses are compared [m].
inline constexpr double kSteadyStretch_m = 15.0;
/// Centre lines of consecutive poses that are nowhere farther apart than this are steady [m].
inline constexpr double kSteady_m = 0.5;
inline constexpr double kCentreLineStep_m = 0.5;

struct CentreLinePoint {
    Point position;
    double heading_rad;
};
/// From the car's foot point on, a point every kCentreLineStep_m; empty where a lane has no centre line.
using CentreLine = std::vector<CentreLinePoint>;

/// The centre line of a lane as a car would drive it (see `drivable`), the first `length_m` of it. Empty
/// where the lane cannot be driven, and where a boundary is empty: what is inferred is not scored.
[[nodiscard]] CentreLine centre_line_of(const LaneOutline& lane, const Pose& pose,
                                        double length_m = kCentreLineLength_m);

/// The same from a polyline: resampled, from the foot point of the car on.
[[nodiscard]] CentreLine centre_line_of(std::span<const Point> polyline, const Pose& pose,
                                        double length_m = kCentreLineLength_m);

/// How far a lane's centre line is from the true one.
struct CentreLineError {
    std::vector<float> lateral_m;       ///< at each point of the first kCentreLineStretch_m that both cover
    std::optional<double> heading_rad;  ///< at kHeadingAt_m, absent where one of them ends before
};
[[nodiscard]] CentreLineError centre_line_error(std::span<const CentreLinePoint> lane,
                                                std::span<const CentreLinePoint> truth);

/// Whether the centre line of a pose agrees with that of the pose before: over the first kSteadyStretch_m
/// that both cover no point of it is farther than kSteady_m from the earlier one. False where they cover
/// nothing in common, so where one of them is empty.
[[nodiscard]] bool is_steady(std::span<const CentreLinePoint> before, std::span<const CentreLinePoint> now);

}  // namespace conelane
