#pragma once

#include "evaluation/tracks/track.hpp"

#include <span>

namespace conelane {

/// Sets `left`, `right` and `closed` of a run by the colored cones of its last map along the path that was
/// driven (see read_run_log). Leaves the track as it is and returns false where they bound no lane.
bool set_boundaries_along(std::span<const Point> path, Track& run);

}  // namespace conelane
