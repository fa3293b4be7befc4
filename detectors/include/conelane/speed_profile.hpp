#pragma once

#include "conelane/drivable_lane.hpp"

#include <limits>
#include <vector>

namespace conelane {

/// What the car can do. Across and along, the tyres share their grip: the friction ellipse.
struct VehicleLimits {
    double a_lateral_mps2 = 9.0;
    double a_brake_mps2 = 6.0;  ///< of the tyres, along the car in both directions
    double a_drive_mps2 = 6.0;  ///< of the motor; the tyres may transmit less
    double v_max_mps = 20.0;
};

/// Where a profile begins and where it has to be at rest.
struct SpeedTask {
    double v_now_mps = 0.0;  ///< at the first point
    /// Along the path, for example Plan::safe_m; infinite: the car need not be able to stop on the path.
    double stop_at_m = std::numeric_limits<double>::infinity();
};

struct SpeedPoint {
    double s_m = 0.0;
    double v_mps = 0.0;
    double a_mps2 = 0.0;  ///< along the car, constant up to the next point or the stop
    double t_s = 0.0;     ///< since the first point; infinite past a stop
};

/// The fastest speeds along an open path: a limit by curvature, a pass forward for driving, a pass backward
/// for braking. If the first speed is below `v_now_mps`, the car is too fast and has to brake at once.
/// One speed for each point of the path. Throws InvalidInput naming a limit that is not positive and finite,
/// a task that is negative or NaN, or a curvature that is not finite.
[[nodiscard]] std::vector<SpeedPoint> speed_profile(const DrivableLane& path,
                                                    const VehicleLimits& limits = {},
                                                    const SpeedTask& task = {});

}  // namespace conelane
