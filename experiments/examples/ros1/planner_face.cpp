#include "experiments/examples/ros1/planner_face.hpp"

#include "conelane/planner.hpp"

#include <array>
#include <chrono>
#include <cmath>

namespace conelane_ros1 {
namespace {

using conelane::ConeColor;

/// The cone in the map. Its covariance C becomes R C R'.
conelane::Cone in_map(const SeenCone& seen, const Planar& from) {
    constexpr std::array kColors{ConeColor::blue, ConeColor::yellow, ConeColor::orange, ConeColor::big_orange,
                                 ConeColor::unknown};
    conelane::Cone cone{.id = conelane::kNoId, .color = kColors.at(static_cast<std::size_t>(seen.color))};
    cone.position = {from.x + from.xx * seen.x_m + from.xy * seen.y_m,
                     from.y + from.yx * seen.x_m + from.yy * seen.y_m};
    const auto along = [&](double ax, double ay, double bx, double by) {
        return ax * (seen.xx_m2 * bx + seen.xy_m2 * by) + ay * (seen.xy_m2 * bx + seen.yy_m2 * by);
    };
    if (seen.xx_m2 != 0.0 || seen.yy_m2 != 0.0) {
        cone.position_covariance = {along(from.xx, from.xy, from.xx, from.xy),
                                    along(from.xx, from.xy, from.yx, from.yy),
                                    along(from.yx, from.yy, from.yx, from.yy)};
    }
    return cone;
}

conelane::PlannerOptions options_of(const std::string& mission, const std::string& detector, int laps) {
    conelane::PlannerOptions options{.mission = conelane::mission_named(mission), .detector = detector};
    if (laps != 0) options.laps = laps;
    return options;
}

}  // namespace

struct PlannerFace::Implementation {
    std::unique_ptr<conelane::Planner> planner;
};

PlannerFace::PlannerFace(const std::string& mission, const std::string& detector, int laps)
    : implementation_(std::make_unique<Implementation>(
          Implementation{conelane::make_planner(options_of(mission, detector, laps))})) {}

PlannerFace::~PlannerFace() = default;

Answer PlannerFace::update(double time_s, const Planar& car, const std::vector<SeenCone>& cones,
                           const Planar& seen_from, double time_limit_ms) {
    conelane::Frame frame{
        .time_s = time_s, .pose = {{car.x, car.y}, std::atan2(car.yx, car.xx)}, .cones = {}};
    for (const SeenCone& cone : cones) frame.cones.push_back(in_map(cone, seen_from));
    const auto start = std::chrono::steady_clock::now();
    const conelane::Plan plan = implementation_->planner->update(frame, {.time_limit_ms = time_limit_ms});
    const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start;
    Answer answer{std::string(to_string(plan.state)),
                  {},
                  {{"lap", std::to_string(plan.lap)},
                   {"phase", std::string(plan.phase)},
                   {"stop", plan.stop ? "true" : "false"},
                   {"safe_m", std::to_string(plan.safe_m)},
                   {"age_s", std::to_string(plan.age_s)},
                   {"detector", std::string(to_string(plan.answer.status))},
                   {"cones", std::to_string(cones.size())},
                   {"latency_ms", std::to_string(spent.count())}}};
    for (const conelane::DrivablePoint& point : plan.lane.points) {
        answer.path.push_back({point.position.x(), point.position.y(), point.heading_rad, point.width_left_m,
                               point.width_right_m, point.s_m <= plan.safe_m});
    }
    return answer;
}

}  // namespace conelane_ros1
