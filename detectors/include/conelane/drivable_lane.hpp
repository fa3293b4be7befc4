#pragma once

#include "conelane/lane.hpp"
#include "conelane/lane_detector.hpp"
#include "conelane/point.hpp"
#include "conelane/scene.hpp"

#include <optional>
#include <vector>

namespace conelane {

/// A point of a lane's centre line, in the frame of reference of the cones.
struct DrivablePoint {
    double s_m = 0.0;  ///< arc length along the centre line from the car's foot point
    Point position{0.0, 0.0};
    double heading_rad = 0.0;    ///< of the driving direction, in (-pi, pi], counter-clockwise, 0 along +x
    double curvature_1pm = 0.0;  ///< [1/m], positive in a left bend
    /// Distance to the boundary along the normal. Past the boundary's end the lane keeps its last width.
    double width_left_m = 0.0;
    double width_right_m = 0.0;  ///< likewise to the right
};

/// A stretch in which two successive cones of a boundary are farther apart than DrivableOptions::max_gap_m:
/// probably a cone between them is missing or was not seen. No cone is added.
struct BridgedGap {
    bool on_left = false;
    double from_s_m = 0.0;  ///< beside the first cone, at least 0
    double to_s_m = 0.0;    ///< beside the second cone; in an open lane DrivableLane::length_m at most, in a
                            ///< closed lane beyond it if the first point is in the gap
};

/// The centre line of a lane, for a controller.
struct DrivableLane {
    /// At equal steps of arc length from the foot point on. In an open lane, the rest at the far end, shorter
    /// than a step, has no point. In a closed lane the step is adjusted to divide the circuit: the last point
    /// is one step before the first one, which is not repeated.
    std::vector<DrivablePoint> points;
    bool closed = false;
    double length_m = 0.0;  ///< of the centre line from the foot point to its end, or once around
    /// Arc length up to which the detector trusts the lane, at most length_m; absent if unknown.
    std::optional<double> trusted_m;
    std::vector<BridgedGap> bridged;  ///< left ones first, then by from_s_m
    /// No cone of this boundary is known: the boundary is assumed at DrivableOptions::default_width_m from
    /// the other one. At most one of the two members is true.
    bool left_inferred = false;
    bool right_inferred = false;
};

struct DrivableOptions {
    double step_m = 0.5;  ///< arc length from point to point, in [0.01, 100]
    /// In [0.25, 5]. Waves of the midpoints of wavelength 2 pi smoothing_m are halved, shorter ones nearly
    /// vanish. A bend of radius 2 smoothing_m keeps its radius within 2 %.
    double smoothing_m = 1.75;
    double max_gap_m = 5.5;  ///< longer gaps are reported as bridged; 5 m by the rules, plus noise; > 0
    /// Width of a lane with only one known boundary, in [1, 6.5]. The rules ask for at least 3 m;
    /// recorded courses are about 3.5 m wide.
    double default_width_m = 3.5;
};

/// The centre line of a lane from the car's foot point on.
///
/// The two boundaries, polylines through their cones, are matched monotonically; a smoothing spline near the
/// midpoints is the centre line. Its curvature is continuous, and it keeps at least 0.1 m from each
/// boundary: it is smoothed less where it would come nearer. The foot point is the nearest point of
/// the centre line whose direction is within 90 degrees of the car's heading, or the nearest of all if there
/// is none. If a lane begins ahead of the car, its first point is the foot point.
///
/// If one boundary of an open lane ends first, the lane goes on along the other one and keeps its width. P is
/// the last place of the other boundary within kMaxLaneWidth_m of that end. The lane goes on to P, but its
/// middle does not cross the line from that end to P. A boundary that begins later is treated likewise. A
/// lane ends before the first place where it is narrower than about 0.8 m, where its boundaries cross or
/// where left and right are swapped; a closed lane is then open.
///
/// If one side of an open lane is empty and the other has at least two cones, the empty side is inferred:
/// beside the known boundary, at default_width_m. `left_inferred` or `right_inferred` says so.
///
/// A lane without extent has no points: no cones; one cone on each side; closed with an empty side; shorter
/// than 0.5 m; at the foot point already ended, too narrow, crossed or swapped. Throws InvalidInput naming
/// the key: an option out of its range, a pose that is not finite, a cone (`left[2]`) that the lane names
/// twice, that the scene lacks or has twice, that is not finite or is farther than 1000 km from the car in x
/// or y, a boundary longer than 20 km, a closed lane of two sides with fewer than three cones on one.
/// Successive cones at one place count as one. The same input gives the same output.
[[nodiscard]] DrivableLane drivable(const Lane& lane, const Scene& scene,
                                    const DrivableOptions& options = {});

/// The same for a detector's answer, with trusted_m. An answer without a lane gives no points.
[[nodiscard]] DrivableLane drivable(const LaneAnswer& answer, const Scene& scene,
                                    const DrivableOptions& options = {});

}  // namespace conelane
