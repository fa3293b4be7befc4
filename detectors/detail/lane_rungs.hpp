#pragma once

#include "detectors/detail/lane_boundary.hpp"
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
/// middles: an odd number, of a closed lane an even one that leaves the first rung out at the end. Both
/// boundaries are sampled and matched monotonically with the least sum of squared rung lengths (dynamic time
/// warping; of equally good steps one on both sides wins, then one on the left). The ends of an open lane's
/// boundaries count as far as they stay within `widest_m` of the other boundary. None where the line of
/// middles is shorter than 0.5 m.
struct RungLadder {
    std::vector<Rung> rungs;
    double spacing_m = 0.0;  ///< between the middles of successive rungs, along their line
};
/// Precondition: both boundaries are closed, or neither is. Takes time and memory quadratic in the boundary
/// lengths up to 1 km; longer ones are sampled more coarsely.
[[nodiscard]] RungLadder lane_rungs(const LaneBoundary& left, const LaneBoundary& right, double widest_m);

}  // namespace conelane
