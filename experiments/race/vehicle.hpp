#pragma once

#include "conelane/scene.hpp"

#include <span>

namespace conelane::experiments {

struct VehicleLimits {
    double wheelbase_m = 1.55;
    double max_steering_rad = 0.55;  ///< turns on a radius of 2.5 m
    double max_steering_rate_radps = 2.0;
};

/// A kinematic bicycle; the pose is that of its rear axle.
struct Vehicle {
    Pose pose;
    double steering_rad = 0.0;

    /// Moves on at a constant speed; the steering follows `wanted_rad` within its limits.
    void drive(double speed_mps, double wanted_rad, double time_s, const VehicleLimits& limits = {});
};

/// The steering angle of pure pursuit along `path`, followed from its beginning on by arc length: the far
/// end of a U-turn may be nearer to the car. `from_m` is the arc length reached and is moved on. 0 if
/// the path has fewer than two points.
[[nodiscard]] double pursue(const Pose& car, std::span<const Point> path, double lookahead_m, double& from_m,
                            const VehicleLimits& limits = {});

}  // namespace conelane::experiments
