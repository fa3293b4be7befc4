#include "conelane/planner.hpp"

#include "conelane/invalid_input.hpp"
#include "detectors/planner/planners.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace conelane {
namespace {

constexpr std::array<std::string_view, 4> kMissions{"trackdrive", "autocross", "acceleration", "skidpad"};
constexpr std::array<std::string_view, 5> kStates{"searching", "following", "bridging", "lost", "finished"};

/// Empty for a value that the enumeration does not have.
template <typename Value>
std::string_view name_of(Value value, std::span<const std::string_view> names) {
    const auto place = static_cast<std::size_t>(value);
    return place < names.size() ? names[place] : "";
}

/// Whether a frame came twice: the same time, pose and cones.
bool is_same(const Frame& a, const Frame& b) {
    return a.time_s == b.time_s && a.pose.position == b.pose.position && a.pose.yaw_rad == b.pose.yaw_rad &&
           std::ranges::equal(a.cones, b.cones, [](const Cone& one, const Cone& other) {
               return one.id == other.id && one.position == other.position && one.color == other.color;
           });
}

}  // namespace

std::string_view to_string(Mission mission) {
    return name_of(mission, kMissions);
}

Mission mission_named(std::string_view name) {
    std::string all;
    for (std::size_t i = 0; i < kMissions.size(); ++i) {
        if (kMissions[i] == name) return static_cast<Mission>(i);
        all += (all.empty() ? "" : ", ") + std::string(kMissions[i]);
    }
    throw InvalidInput("mission", "there is no '" + std::string(name) + "', only " + all);
}

std::string_view to_string(PlanState state) {
    return name_of(state, kStates);
}

Planner::~Planner() = default;

std::unique_ptr<Planner> make_planner(const PlannerOptions& options) {
    switch (options.mission) {
        case Mission::trackdrive:
        case Mission::autocross:
            return make_lap_planner(options);
        case Mission::acceleration:
        case Mission::skidpad:
            return make_known_course_planner(options);
    }
    throw InvalidInput("mission", "is not a mission");
}

Scene checked_scene(const Frame& frame, const DetectionLimits& limits) {
    if (!std::isfinite(frame.time_s)) throw InvalidInput("time_s", "is not finite");
    if (std::isnan(limits.time_limit_ms)) throw InvalidInput("time_limit_ms", "is not a number");
    Scene scene{"frame", frame.pose, frame.cones};
    std::vector<ConeId> used;
    for (const Cone& cone : frame.cones) {
        if (cone.id != kNoId) used.push_back(cone.id);
    }
    std::ranges::sort(used);
    ConeId next = 0;
    for (Cone& cone : scene.cones) {
        if (cone.id != kNoId) continue;
        while (std::ranges::binary_search(used, next)) ++next;
        cone.id = next++;
    }
    validate(scene);
    return scene;
}

Plan plan_not_later(const Plan& last, const Frame& last_frame, const Frame& frame) {
    Plan plan = last;
    if (is_same(frame, last_frame)) return plan;
    const double moved_m = (frame.pose.position - last_frame.pose.position).norm();
    plan.safe_m = std::max(0.0, plan.safe_m - moved_m);
    if (plan.state == PlanState::following) plan.state = PlanState::bridging;
    if (plan.state == PlanState::bridging) plan.reason = "the frame is not later than the one before";
    return plan;
}

void validate_shared(const PlannerOptions& options) {
    if (!(options.max_age_s >= 0.0)) throw InvalidInput("max_age_s", "must be at least 0");
    // A lane that is shorter than a step has no points.
    if (options.drivable.step_m > 5.0) throw InvalidInput("step_m", "must be at most 5 in a planner");
    static_cast<void>(drivable(Lane{}, Scene{}, options.drivable));  // throws if an option is out of range
}

}  // namespace conelane
