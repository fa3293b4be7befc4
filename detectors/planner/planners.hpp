#pragma once

#include "conelane/planner.hpp"

namespace conelane {

/// Acceleration and skidpad: the rules give the shape of the course. The shape is registered to the cones,
/// and the lane is the route of the rules from the car on, 1.5 m wide to each side (acceleration: as wide as
/// the cones show).
///
/// The detector runs only until the registration is trusted; after that `Plan::answer` has its default.
/// `Plan::lap` counts the completed circles of the skidpad, and is 0 in acceleration. `PlannerOptions::laps`
/// must be absent.
[[nodiscard]] std::unique_ptr<Planner> make_known_course_planner(const PlannerOptions& options);

/// Trackdrive and autocross: laps of a course that is not known in advance.
[[nodiscard]] std::unique_ptr<Planner> make_lap_planner(const PlannerOptions& options);
/// By this detector, whatever `options` names.
[[nodiscard]] std::unique_ptr<Planner> make_lap_planner(const PlannerOptions& options,
                                                        std::unique_ptr<LaneDetector> detector);

/// The frame as a scene. Cones without id get the lowest ids that no cone of the frame has. Throws
/// InvalidInput if the frame is invalid (a time that is not finite, or an invalid scene), or the time limit
/// is not a number.
[[nodiscard]] Scene checked_scene(const Frame& frame, const DetectionLimits& limits);

/// The plan of a frame that is not later than the last one: that of the last one, whose trusted length ends
/// where it ended, and only `bridging` unless the two frames are equal.
[[nodiscard]] Plan plan_not_later(const Plan& last, const Frame& last_frame, const Frame& frame);

/// Throws InvalidInput naming an option that is invalid for every mission: max_age_s or one of `drivable`.
void validate_shared(const PlannerOptions& options);

}  // namespace conelane
