#pragma once

#include "conelane/lane.hpp"
#include "conelane/lane_detector.hpp"
#include "conelane/point.hpp"
#include "conelane/scene.hpp"

#include <optional>
#include <vector>

namespace conelane {

/// A point of a lane's centre line, in the map frame.
struct DrivablePoint {
    double s_m = 0.0;  ///< arc length along the centre line from the car's foot point
    Point position{0.0, 0.0};
    double heading_rad = 0.0;    ///< of the driving direction, in (-pi, pi], counter-clockwise, 0 along +x
    double curvature_1pm = 0.0;  ///< [1/m], positive in a left bend
    /// Along the normal to the first place where it meets the boundary. Where the boundary has ended, it is
    /// taken to go on beside the other one, the lane keeping its width.
    double width_left_m = 0.0;
    double width_right_m = 0.0;  ///< in the same way
};

/// A stretch in which a boundary joins two cones that stand farther apart than the rules allow: a cone
/// between them is missing or was missed. No cone is invented for it.
struct BridgedGap {
    bool on_left = false;
    double from_s_m = 0.0;  ///< beside its first cone, at least 0
    double to_s_m = 0.0;  ///< beside its second one; past DrivableLane::length_m where a closed lane's first
                          ///< point lies in the gap
};

/// The centre line of a lane, ready to be driven.
struct DrivableLane {
    /// At equal arc lengths. An open lane has one every step from the foot point on; what is left at the far
    /// end, less than a step, has no point. A closed lane stretches or shortens the step so that it divides
    /// the circuit: the last point stands a step before the first one, which is not repeated.
    std::vector<DrivablePoint> points;
    bool closed = false;
    double length_m = 0.0;  ///< of the centre line from the foot point to its end, or once around
    /// Arc length up to which the detector trusts the lane, at most length_m; absent where it does not know.
    std::optional<double> trusted_m;
    std::vector<BridgedGap> bridged;  ///< left ones first, then by from_s_m
    /// No cone of this boundary is known: it is taken to lie DrivableOptions::default_width_m from the other
    /// one, and the widths to that side say no more than that. At most one of both.
    bool left_inferred = false;
    bool right_inferred = false;
};

struct DrivableOptions {
    double step_m = 0.5;  ///< arc length from point to point, in [0.01, 100]
    /// Length scale of the smoothing, in [0.25, 5]: waves of the centre line that are shorter than 2 pi times
    /// it are taken out, a bend whose radius is twice as long keeps it within 2 %.
    double smoothing_m = 1.75;
    double max_gap_m = 5.5;  ///< longer ones are bridged; 5 m by the rules and a margin for noise; > 0
    /// Width of a lane of which one boundary alone is known, in [1, 6.5]. The rules ask for 3 m at least;
    /// recorded courses are about 3.5 m wide.
    double default_width_m = 3.5;
};

/// The centre line of a lane from the car's foot point on.
///
/// The two boundaries, polylines through their cones, are matched monotonically; a smoothing spline through
/// the midpoints is the centre line. It has a continuous curvature and keeps 0.1 m at least from either
/// boundary: where smoothing would take it nearer, it smooths less. The foot point is the nearest point of
/// the centre line that runs within 90 degrees of the car's heading, or the nearest of all where none does.
/// A lane that begins ahead of the car has it at its beginning.
///
/// An open lane begins where both boundaries have begun. Where one boundary ends first, the lane goes on
/// along the other and keeps its width, as far as that stays within kMaxLaneWidth_m of the end and does not
/// pass the line between both ends. Any lane ends before the first place where it is narrower than about 0.8
/// m, where its boundaries cross or where left and right are swapped; a closed one is then open.
///
/// Where one side of an open lane is empty and the other has two cones at least, the empty one is inferred:
/// beside the known boundary, at the usual width. `left_inferred` or `right_inferred` says so.
///
/// A lane without extent has no points: one without cones, with one cone on either side, with an empty side
/// that is closed, shorter than 0.5 m, or unusable at the foot point. Throws InvalidInput naming the key
/// where an option is out of its range, the pose is not finite, the lane names a cone twice or one that the
/// scene has not (`left[2]`), a cone of it is not finite or farther than 1000 km from the car, a boundary is
/// longer than 20 km, or a closed lane has fewer than three cones on a side. Cones at one place count as one.
/// The same input gives the same output.
[[nodiscard]] DrivableLane drivable(const Lane& lane, const Scene& scene,
                                    const DrivableOptions& options = {});

/// The same for a detector's answer, with trusted_m. An answer that is not found gives no points.
[[nodiscard]] DrivableLane drivable(const LaneAnswer& answer, const Scene& scene,
                                    const DrivableOptions& options = {});

}  // namespace conelane
