#pragma once

#include <span>
#include <string>

namespace conelane {

/// What lies between the map of a course and what a car sees of it.
struct Condition {
    std::string name;                   ///< empty where none was named
    double noise_sigma_m = 0.0;         ///< Gaussian, on each coordinate of a seen map point
    double pose_noise_lateral_m = 0.0;  ///< Gaussian, across the heading
    double pose_noise_yaw_rad = 0.0;    ///< Gaussian
    double miss_rate = 0.0;             ///< share of visible map points not seen
    bool persistent = false;            ///< false positives keep id and place along a lap
};

/// The conditions that have a name, so that tables can be compared: `paper`, where nothing is disturbed,
/// `car` and `harsh`.
[[nodiscard]] std::span<const Condition> named_conditions();

}  // namespace conelane
