#include "conelane/planner.hpp"

#include "conelane/invalid_input.hpp"
#include "detectors/planner/known_course_planner.hpp"
#include "detectors/planner/lap_planner.hpp"

#include <string>

namespace conelane {

std::string_view to_string(Mission mission) {
    switch (mission) {
        case Mission::trackdrive:
            return "trackdrive";
        case Mission::autocross:
            return "autocross";
        case Mission::acceleration:
            return "acceleration";
        case Mission::skidpad:
            return "skidpad";
    }
    return "";
}

Mission mission_named(std::string_view name) {
    std::string all;
    for (const Mission mission :
         {Mission::trackdrive, Mission::autocross, Mission::acceleration, Mission::skidpad}) {
        if (to_string(mission) == name) return mission;
        all += (all.empty() ? "" : ", ") + std::string(to_string(mission));
    }
    throw InvalidInput("mission", "there is no '" + std::string(name) + "', only " + all);
}

std::string_view to_string(PlanState state) {
    switch (state) {
        case PlanState::searching:
            return "searching";
        case PlanState::following:
            return "following";
        case PlanState::bridging:
            return "bridging";
        case PlanState::lost:
            return "lost";
        case PlanState::finished:
            return "finished";
    }
    return "";
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

}  // namespace conelane
