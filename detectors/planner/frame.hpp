#pragma once

#include "conelane/planner.hpp"

namespace conelane {

/// The frame as a scene. Cones without id get the lowest ids that no cone of the frame has.
///
/// Throws InvalidInput where the frame is not valid (its time is not finite, or it is no valid scene), or the
/// time limit is not a number.
[[nodiscard]] Scene checked_scene(const Frame& frame, const DetectionLimits& limits);

/// Throws InvalidInput naming the option that no mission takes: max_age_s or one of `drivable`.
void validate_shared(const PlannerOptions& options);

}  // namespace conelane
