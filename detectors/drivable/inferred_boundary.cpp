#include "detectors/drivable/inferred_boundary.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace conelane {
namespace {

constexpr double kStep_m = 0.5;
constexpr double kMaxSteps = 2000.0;       ///< of a boundary; a longer one is sampled more coarsely
constexpr double kDirectionReach_m = 2.5;  ///< to either side
/// A point opposite to the known boundary must be at least this share of the width from that boundary.
constexpr double kNearestShare = 0.85;

/// A point of a polyline at an arc length. At both ends, the polyline continues straight.
Point point_at(const LaneBoundary& boundary, double arc_m) {
    std::size_t i = 0;
    while (i + 1 < boundary.segments() && boundary.segment_end_m(i) < arc_m) ++i;
    const Segment segment = boundary.segment(i);
    const double start_m = boundary.segment_start_m(i);
    const double share = (arc_m - start_m) / (boundary.segment_end_m(i) - start_m);
    return segment.from + share * (segment.to - segment.from);
}

}  // namespace

std::vector<Point> inferred_boundary(const LaneBoundary& known, bool known_is_left, double width_m) {
    std::vector<Point> across;
    if (known.segments() == 0) return across;
    const double length_m = known.length_m();
    const double steps = std::clamp(std::ceil(length_m / kStep_m), 1.0, kMaxSteps);
    const double side = known_is_left ? -1.0 : 1.0;
    for (double k = 0.0; k <= steps; ++k) {
        const double arc_m = length_m * k / steps;
        const Point from = point_at(known, arc_m);
        const Point direction =
            point_at(known, arc_m + kDirectionReach_m) - point_at(known, arc_m - kDirectionReach_m);
        const double norm_m = direction.norm();
        if (!(norm_m > 0.0)) continue;
        const Point point = from + side * width_m / norm_m * Point(-direction.y(), direction.x());
        if (known.distance_m(point, arc_m, length_m) < kNearestShare * width_m) continue;
        if (!across.empty() && (point - across.back()).dot(direction) <= 0.0) continue;
        across.push_back(point);
    }
    return across;
}

}  // namespace conelane
