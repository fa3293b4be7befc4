#pragma once

#include "graph_search/clc/lane_constraints.hpp"
#include "model/geometry.hpp"

#include <span>

namespace conelane {

/// Whether a lane can be closed to a circuit, section IV-E of the CLC paper: on both sides the last point is
/// within d_max of the first, and the closed lane satisfies the constraints. For a closed lane these are:
/// C_seg also at both ends of each closing segment; C_width with the closing segments as queries and targets;
/// and for C_poly, each boundary is a simple polygon, they have no point in common and one encloses the
/// other. False if a side has fewer than three points.
[[nodiscard]] bool can_be_closed(std::span<const Point> left, std::span<const Point> right, double d_max_m,
                                 const LaneBounds& bounds);

}  // namespace conelane
