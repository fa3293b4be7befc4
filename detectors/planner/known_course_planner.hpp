#pragma once

#include "conelane/planner.hpp"

#include <memory>

namespace conelane {

/// Acceleration and skidpad: courses whose shape the rules give. The shape is registered to the cones, and
/// the lane is the route of the rules from the car on, 1.5 m wide to either side (acceleration: as wide as
/// the cones show).
///
/// The detector runs only until the registration is trusted; `Plan::answer` has its default afterwards.
/// `Plan::lap` counts the circles of the skidpad that are complete, and is 0 in acceleration.
/// `PlannerOptions::laps` must be absent. A frame that is not later than the last one changes nothing: it has
/// the last plan, as bridging instead of following where it is older.
[[nodiscard]] std::unique_ptr<Planner> make_known_course_planner(const PlannerOptions& options);

}  // namespace conelane
