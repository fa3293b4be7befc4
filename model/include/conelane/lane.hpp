#pragma once

#include "conelane/scene.hpp"

#include <cstddef>
#include <vector>

namespace conelane {

/// Both boundaries of a lane, as cone ids in driving order from the car outward. One of them may be empty
/// where the other alone was found; then the lane is not closed.
struct Lane {
    std::vector<ConeId> left;
    std::vector<ConeId> right;
    bool closed = false;  ///< a whole circuit: each boundary returns from its last cone to its first

    bool operator==(const Lane&) const = default;
};

/// Widest lane of scenes, scores and defaults [m]: beyond it one side has gone on alone.
inline constexpr double kMaxLaneWidth_m = 6.5;

/// Drops far ends until the last cone of each side is within `widest_m` of the polyline of the other side;
/// where both ends are too far, the left one goes first. A closed lane stays as it is, and so does a lane
/// with an empty side. Precondition: every id of the lane is a cone of the scene.
void even_far_ends(Lane& lane, const Scene& scene, double widest_m = kMaxLaneWidth_m);

/// The lane restricted to the scene's `nearest` cones ahead: each boundary is cut at its first cone that is
/// not one of them, then the far ends are evened. A boundary may be left with one cone or none, and only a
/// lane that was not cut stays closed. Precondition: every id of the lane is a cone of the scene.
[[nodiscard]] Lane cut_to_nearest(Lane lane, const Scene& scene, std::size_t nearest,
                                  double widest_m = kMaxLaneWidth_m);

}  // namespace conelane
