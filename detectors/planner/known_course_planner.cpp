#include "detectors/planner/known_course_planner.hpp"

#include "conelane/invalid_input.hpp"

namespace conelane {

std::unique_ptr<Planner> make_known_course_planner(const PlannerOptions& options) {
    throw InvalidInput("mission", "'" + std::string(to_string(options.mission)) + "' is not built yet");
}

}  // namespace conelane
