#include "conelane/speed_profile.hpp"

#include "conelane/invalid_input.hpp"

#include <utility>

namespace conelane {
namespace {

void validate(const VehicleLimits& limits, const SpeedTask& task) {
    for (const auto& [name, value] :
         {std::pair("a_lateral", limits.a_lateral_mps2), std::pair("a_brake", limits.a_brake_mps2),
          std::pair("a_drive", limits.a_drive_mps2), std::pair("v_max", limits.v_max_mps)}) {
        if (!(value > 0.0 && std::isfinite(value))) throw InvalidInput(name, "must be positive and finite");
    }
    if (!(task.v_now_mps >= 0.0 && std::isfinite(task.v_now_mps)))
        throw InvalidInput("v_now", "must be at least 0 and finite");
    if (!(task.stop_at_m >= 0.0)) throw InvalidInput("stop_at_m", "must be at least 0");
}

/// What the tyres transmit along the car in a bend.
double along_mps2(double v_mps, double curvature_1pm, const VehicleLimits& limits) {
    const double share = v_mps * v_mps * std::abs(curvature_1pm) / limits.a_lateral_mps2;
    return limits.a_brake_mps2 * std::sqrt(std::max(0.0, 1.0 - share * share));
}

/// The speed at the beginning of a step from which braking leads to `v_mps` at its end. The grip left in a
/// bend is the smaller of that at both ends.
double before_braking_mps(double v_mps, double step_m, double curvature_1pm, double curvature_before_1pm,
                          const VehicleLimits& limits) {
    const auto from = [&](double a_mps2) { return std::sqrt(v_mps * v_mps + 2.0 * a_mps2 * step_m); };
    const double by_end_mps = from(along_mps2(v_mps, curvature_1pm, limits));
    return std::min(by_end_mps, from(along_mps2(by_end_mps, curvature_before_1pm, limits)));
}

}  // namespace

std::vector<SpeedPoint> speed_profile(const DrivableLane& path, const VehicleLimits& limits,
                                      const SpeedTask& task) {
    validate(limits, task);
    const std::vector<DrivablePoint>& points = path.points;
    std::vector<SpeedPoint> profile(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double bend_1pm = std::abs(points[i].curvature_1pm);
        if (!std::isfinite(bend_1pm)) throw InvalidInput("curvature_1pm", "must be finite");
        const double in_bend_mps = std::sqrt(limits.a_lateral_mps2 / std::max(bend_1pm, 1e-12));
        profile[i].s_m = points[i].s_m;
        profile[i].v_mps = points[i].s_m < task.stop_at_m ? std::min(limits.v_max_mps, in_bend_mps) : 0.0;
    }
    if (profile.empty()) return profile;
    profile.front().v_mps = std::min(profile.front().v_mps, task.v_now_mps);
    for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
        const double v_mps = profile[i].v_mps;
        const double a_mps2 =
            std::min(limits.a_drive_mps2, along_mps2(v_mps, points[i].curvature_1pm, limits));
        const double reached_mps =
            std::sqrt(v_mps * v_mps + 2.0 * a_mps2 * (profile[i + 1].s_m - profile[i].s_m));
        profile[i + 1].v_mps = std::min(profile[i + 1].v_mps, reached_mps);
    }
    // The stop may be behind the last point, where the path ends between two points or further on.
    if (const double rest_m = task.stop_at_m - points.back().s_m; rest_m > 0.0 && std::isfinite(rest_m)) {
        const double bend_1pm = points.back().curvature_1pm;
        SpeedPoint& last = profile.back();
        last.v_mps = std::min(last.v_mps, before_braking_mps(0.0, rest_m, bend_1pm, bend_1pm, limits));
        last.a_mps2 = -last.v_mps * last.v_mps / (2.0 * rest_m);
    }
    for (std::size_t i = profile.size() - 1; i-- > 0;) {
        const double next_m = std::min(profile[i + 1].s_m, task.stop_at_m);  // the stop may be in this step
        const double step_m = std::max(0.0, next_m - profile[i].s_m);
        profile[i].v_mps = std::min(
            profile[i].v_mps, before_braking_mps(profile[i + 1].v_mps, step_m, points[i + 1].curvature_1pm,
                                                 points[i].curvature_1pm, limits));
    }
    for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
        SpeedPoint& here = profile[i];
        SpeedPoint& next = profile[i + 1];
        const bool stops = here.s_m < task.stop_at_m && task.stop_at_m < next.s_m;
        const double step_m = (stops ? task.stop_at_m : next.s_m) - here.s_m;
        here.a_mps2 = (next.v_mps * next.v_mps - here.v_mps * here.v_mps) / (2.0 * step_m);
        next.t_s = stops ? std::numeric_limits<double>::infinity()
                         : here.t_s + 2.0 * step_m / (here.v_mps + next.v_mps);
    }
    return profile;
}

}  // namespace conelane
