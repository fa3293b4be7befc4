#pragma once

#include "conelane/planner.hpp"

#include <memory>

namespace conelane {

/// Acceleration and skidpad: the rules give the shape of the course. The shape is registered to the cones,
/// and the lane is the route of the rules from the car on, 1.5 m wide to each side (acceleration: as wide as
/// the cones show).
///
/// The detector runs only until the registration is trusted; after that `Plan::answer` has its default.
/// `Plan::lap` counts the completed circles of the skidpad, and is 0 in acceleration. `PlannerOptions::laps`
/// must be absent. A frame that is not later than the last one changes nothing: the last plan is returned, as
/// bridging instead of following if the frame is older.
[[nodiscard]] std::unique_ptr<Planner> make_known_course_planner(const PlannerOptions& options);

}  // namespace conelane
