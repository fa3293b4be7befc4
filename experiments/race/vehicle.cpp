#include "experiments/race/vehicle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace conelane::experiments {
namespace {

/// Longest travel along the path between two calls [m].
constexpr double kMaxProgress_m = 3.0;

Point target_at(std::span<const Point> path, double arc_length_m) {
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
        const double segment_m = (path[i + 1] - path[i]).norm();
        if (arc_length_m < segment_m) return path[i] + arc_length_m / segment_m * (path[i + 1] - path[i]);
        arc_length_m -= segment_m;
    }
    // Behind its end, a path continues straight, so that a short path keeps its direction.
    const Point last = path.back() - path[path.size() - 2];
    return last.norm() > 0.0 ? Point(path.back() + arc_length_m * last.normalized()) : path.back();
}

}  // namespace

void Vehicle::drive(double speed_mps, double wanted_rad, double time_s, const VehicleLimits& limits) {
    const double target_rad = std::clamp(wanted_rad, -limits.max_steering_rad, limits.max_steering_rad);
    const double change_rad = limits.max_steering_rate_radps * time_s;
    steering_rad += std::clamp(target_rad - steering_rad, -change_rad, change_rad);
    const double turn_rad = speed_mps * std::tan(steering_rad) / limits.wheelbase_m * time_s;
    const double yaw_rad = pose.yaw_rad + turn_rad / 2.0;  // midpoint rule
    pose.position += speed_mps * time_s * Point(std::cos(yaw_rad), std::sin(yaw_rad));
    pose.yaw_rad = std::remainder(pose.yaw_rad + turn_rad, 2.0 * std::acos(-1.0));
}

double pursue(const Pose& car, std::span<const Point> path, double lookahead_m, double& from_m,
              const VehicleLimits& limits) {
    if (path.size() < 2) return 0.0;
    double best_m = from_m;
    double best_distance_m = std::numeric_limits<double>::infinity();
    double begin_m = 0.0;
    for (std::size_t i = 0; i + 1 < path.size() && begin_m <= from_m + kMaxProgress_m; ++i) {
        const Point along = path[i + 1] - path[i];
        const double segment_m = along.norm();
        if (segment_m > 0.0 && begin_m + segment_m >= from_m) {
            const double on_m = std::clamp((car.position - path[i]).dot(along) / segment_m, 0.0, segment_m);
            const double at_m = std::clamp(begin_m + on_m, from_m, from_m + kMaxProgress_m);
            const Point foot = path[i] + (at_m - begin_m) / segment_m * along;
            if (const double distance_m = (foot - car.position).norm(); distance_m < best_distance_m) {
                best_distance_m = distance_m;
                best_m = at_m;
            }
        }
        begin_m += segment_m;
    }
    from_m = best_m;
    const Point target = target_at(path, from_m + lookahead_m);
    const double distance_m = (target - car.position).norm();
    if (distance_m < 1e-6) return 0.0;
    const double curvature_1pm = 2.0 * car.left_m(target) / (distance_m * distance_m);
    return std::atan(limits.wheelbase_m * curvature_1pm);
}

}  // namespace conelane::experiments
