#pragma once

#include "conelane/scene.hpp"

#include <cstddef>
#include <vector>

namespace conelane {

/// Both boundaries of a lane, as cone ids in driving order from the car outward. If only one boundary was
/// found, the other is empty and the lane is not closed.
struct Lane {
    std::vector<ConeId> left;
    std::vector<ConeId> right;
    bool closed = false;  ///< a whole circuit: each boundary returns from its last cone to its first

    bool operator==(const Lane&) const = default;
};

/// Largest width in scores and defaults, and of far ends in scenes [m]. If the ends of the boundaries
/// are farther apart, one has gone on alone.
inline constexpr double kMaxLaneWidth_m = 6.5;

/// Drops cones from the far ends until the last cone of each side is within `widest_m` [m] of the polyline of
/// the other side, or a side is empty. If both last cones are too far, the left one is dropped first. A
/// closed lane stays unchanged. Precondition: every id of the lane is a cone of the scene.
void even_far_ends(Lane& lane, const Scene& scene, double widest_m = kMaxLaneWidth_m);

/// The lane cut to the `nearest` cones ahead (see nearest_ahead): each boundary ends before its first cone
/// that is not one of them, then even_far_ends is applied. A boundary may keep one cone or none. A lane that
/// was cut is not closed. Precondition: every id of the lane is a cone of the scene.
[[nodiscard]] Lane cut_to_nearest(Lane lane, const Scene& scene, std::size_t nearest,
                                  double widest_m = kMaxLaneWidth_m);

}  // namespace conelane
