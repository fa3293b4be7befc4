#pragma once

#include <span>
#include <string>
#include <vector>

namespace conelane {

/// Disturbances between the map of a course and the cones that a car sees.
struct Condition {
    std::string name;                   ///< empty without a name
    double noise_sigma_m = 0.0;         ///< Gaussian, on each coordinate of a seen map point
    double pose_noise_lateral_m = 0.0;  ///< Gaussian, across the heading
    double pose_noise_yaw_rad = 0.0;    ///< Gaussian
    double miss_rate = 0.0;             ///< share of visible map points not seen
    bool persistent = false;            ///< false positives keep id and place along a lap
    /// Standard deviation of each coordinate that is added to noise_sigma_m for each metre between cone and
    /// car, as the root of the sum of squares. Above 0 every cone of a scene carries its covariance.
    double noise_by_range = 0.0;

    /// Standard deviation of each coordinate of a point seen at that distance [m].
    [[nodiscard]] double noise_m(double distance_m) const;
};

/// The named conditions, so that tables can be compared: `paper`, without disturbances, `car` and `harsh`.
[[nodiscard]] std::span<const Condition> named_conditions();

/// How names of conditions and ids of scenes spell the disturbances: "noise_0.1", "pose_noise_0.3_0.09",
/// "miss_0.05", "noise_by_range_0.01".
[[nodiscard]] std::string noise_text(const Condition& condition);
[[nodiscard]] std::string pose_noise_text(const Condition& condition);
[[nodiscard]] std::string miss_text(const Condition& condition);
[[nodiscard]] std::string noise_by_range_text(const Condition& condition);
/// The texts of the condition's disturbances, and "persist", in the order of ids.
[[nodiscard]] std::vector<std::string> disturbances(const Condition& condition);

}  // namespace conelane
