#include "evaluation/world/condition.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace conelane {

std::span<const Condition> named_conditions() {
    constexpr double kDegree_rad = std::numbers::pi / 180.0;
    static const std::array<Condition, 4> conditions{{
        {.name = "paper"},
        {.name = "car",
         .noise_sigma_m = 0.1,
         .pose_noise_lateral_m = 0.3,
         .pose_noise_yaw_rad = 5.0 * kDegree_rad,
         .miss_rate = 0.05,
         .persistent = true},
        {.name = "harsh",
         .noise_sigma_m = 0.2,
         .pose_noise_lateral_m = 0.5,
         .pose_noise_yaw_rad = 8.0 * kDegree_rad,
         .miss_rate = 0.1,
         .persistent = true},
        {.name = "slam",
         .noise_sigma_m = 0.1,
         .pose_noise_lateral_m = 0.1,
         .pose_noise_yaw_rad = 1.0 * kDegree_rad,
         .miss_rate = 0.05,
         .persistent = true},
    }};
    return conditions;
}

double Condition::noise_m(double distance_m) const {
    return noise_by_range > 0.0 ? std::hypot(noise_sigma_m, noise_by_range * distance_m) : noise_sigma_m;
}

std::string noise_text(const Condition& condition) {
    return fmt::format("noise_{}", condition.noise_sigma_m);
}
std::string pose_noise_text(const Condition& condition) {
    return fmt::format("pose_noise_{}_{}", condition.pose_noise_lateral_m, condition.pose_noise_yaw_rad);
}
std::string miss_text(const Condition& condition) {
    return fmt::format("miss_{}", condition.miss_rate);
}
std::string noise_by_range_text(const Condition& condition) {
    return fmt::format("noise_by_range_{}", condition.noise_by_range);
}

std::vector<std::string> disturbances(const Condition& condition) {
    std::vector<std::string> parts;
    if (condition.noise_sigma_m > 0.0) parts.push_back(noise_text(condition));
    if (condition.noise_by_range > 0.0) parts.push_back(noise_by_range_text(condition));
    if (condition.pose_noise_lateral_m > 0.0 || condition.pose_noise_yaw_rad > 0.0) {
        parts.push_back(pose_noise_text(condition));
    }
    if (condition.miss_rate > 0.0) parts.push_back(miss_text(condition));
    if (condition.persistent) parts.emplace_back("persist");
    return parts;
}

}  // namespace conelane
