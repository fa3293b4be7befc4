#pragma once

#include "conelane/scene.hpp"

namespace conelane {

/// Both boundaries of a lane as positions [m] in driving order; `closed` as in Lane.
struct LaneOutline {
    std::vector<Point> left;
    std::vector<Point> right;
    bool closed = false;
};

/// Mean of both boundary lengths [m]; for a closed lane with the segment from the last vertex to the first.
[[nodiscard]] double lane_length_m(const LaneOutline& lane);

/// Area [m^2] of the region of a lane: all points about which its outline winds clockwise.
///
/// The outline is the left boundary followed by the reversed right one; for a closed lane, the left circuit
/// and the reversed right circuit. So only the clockwise parts of a polygon that crosses itself count, a lane
/// with swapped sides has no region, and the region of a closed lane is the ring between its circuits. Where
/// parts overlap, turns add up: a clockwise part under a counter-clockwise one does not count, and a lane
/// that overlaps itself counts once. A side with fewer than two vertices has no region.
///
/// Positions are rounded to 1 um, and more coarsely if the lane extends over more than 2 km. Any finite
/// outline is valid: repeated vertices, spikes, collinear and coincident edges.
[[nodiscard]] double lane_area_m2(const LaneOutline& lane);

/// Area of the intersection over area of the union of two lane regions, in [0, 1]; exactly 1 for a lane with
/// a region and itself, 0 if a region has no area. Symmetric.
[[nodiscard]] double intersection_over_union(const LaneOutline& a, const LaneOutline& b);

/// The same for lanes whose outlines do not cross themselves, such as those that satisfy the constraints of
/// CLC, by a sum over pairs of edges: ten times as fast, exact except for rounding. For other lanes the
/// result is different: a point counts with the product of the turns about it.
[[nodiscard]] double intersection_over_union_of_simple(const LaneOutline& a, const LaneOutline& b);

}  // namespace conelane
