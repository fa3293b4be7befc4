#pragma once

#include "conelane/planner.hpp"

#include <memory>

namespace conelane {

/// Acceleration and skidpad: courses whose shape the rules give.
[[nodiscard]] std::unique_ptr<Planner> make_known_course_planner(const PlannerOptions& options);

}  // namespace conelane
