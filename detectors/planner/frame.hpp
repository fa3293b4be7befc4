#pragma once

#include "conelane/planner.hpp"

namespace conelane {

/// The frame as a scene. Cones without id get the lowest ids that no cone of the frame has.
///
/// Throws InvalidInput if the frame is invalid (a time that is not finite, or an invalid scene), or the time
/// limit is not a number.
[[nodiscard]] Scene checked_scene(const Frame& frame, const DetectionLimits& limits);

/// Throws InvalidInput naming an option that is invalid for every mission: max_age_s or one of `drivable`.
void validate_shared(const PlannerOptions& options);

}  // namespace conelane
