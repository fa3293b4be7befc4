#pragma once

#include "detectors/drivable/lane_boundary.hpp"
#include "model/geometry.hpp"

#include <vector>

namespace conelane {

/// The unknown boundary of a lane that is `width_m` wide: a point opposite to every half metre of the known
/// boundary, in driving order. Directions are averaged over several metres, so the inferred boundary does not
/// jump where a cone turns the known one. In narrow bends, points that run backwards or come near the known
/// boundary are left out. Precondition: the boundary is open.
[[nodiscard]] std::vector<Point> inferred_boundary(const LaneBoundary& known, bool known_is_left,
                                                   double width_m);

}  // namespace conelane
