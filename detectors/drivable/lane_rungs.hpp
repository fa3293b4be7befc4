#pragma once

#include "detectors/drivable/lane_boundary.hpp"
#include "detectors/drivable/time_check.hpp"
#include "model/geometry.hpp"

#include <vector>

namespace conelane {

/// Places of both boundaries that face each other.
struct Rung {
    Point left;
    Point right;
    double left_m;   ///< place along the left boundary; of a closed one it may exceed its length
    double right_m;  ///< along the right one

    [[nodiscard]] Point middle() const { return 0.5 * (left + right); }
};

/// Rungs of a lane in driving order, at equal distances of at most a quarter metre along the line of their
/// middles: an odd number, of a closed lane an even one that leaves the first rung out at the end. None where
/// that line is shorter than 0.5 m.
struct RungLadder {
    LaneBoundary left;  ///< with what was added where it ends before the right one
    LaneBoundary right;
    std::vector<Rung> rungs;
    double spacing_m = 0.0;  ///< between the middles of successive rungs, along their line
};

/// Samples both boundaries and matches them monotonically with the least sum of squared rung lengths (dynamic
/// time warping; of equally good steps one on both sides wins, then one on the left).
///
/// Where a boundary of an open lane ends before the other one, the matching ends at the place that faces its
/// end. From there the lane keeps its width along the other boundary for as long as that stays within
/// `widest_m` of the end, yet not past the line between both ends.
///
/// Precondition: both boundaries are closed, or neither is. Takes time and memory quadratic in the boundary
/// lengths up to 1 km; longer ones are sampled more coarsely.
[[nodiscard]] RungLadder lane_rungs(const LaneBoundary& left, const LaneBoundary& right, double widest_m,
                                    const TimeCheck& check_time = {});

}  // namespace conelane
