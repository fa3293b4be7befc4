#pragma once

#include "evaluation/world/track.hpp"

#include <span>

namespace conelane {

/// Sets `left`, `right` and `closed` of a run by the colored cones of its last map along the driven path (see
/// read_run_log). If they do not bound a lane, it returns false and the track stays unchanged.
bool set_boundaries_along(std::span<const Point> path, Track& run);

}  // namespace conelane
