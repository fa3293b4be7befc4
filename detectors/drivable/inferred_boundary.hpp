#pragma once

#include "detectors/drivable/lane_boundary.hpp"
#include "model/geometry.hpp"

#include <vector>

namespace conelane {

/// The other boundary of a lane that is `width_m` wide and of which one boundary alone is known: a point
/// across from every half metre of it, in driving order. Directions are taken over several metres, so that
/// the inferred boundary does not leap where a cone turns the known one. Where a bend is so narrow that the
/// points across run backwards or near the known boundary, they are left out. Precondition: the boundary is
/// open.
[[nodiscard]] std::vector<Point> inferred_boundary(const LaneBoundary& known, bool known_is_left,
                                                   double width_m);

}  // namespace conelane
