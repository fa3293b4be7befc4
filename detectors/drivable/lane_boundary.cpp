#include "detectors/drivable/lane_boundary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace conelane {
namespace {

constexpr double kOnePlace_m = 1e-6;       ///< vertices closer than this are at one place
constexpr double kParallelSine = 1e-12;    ///< a ray parallel to a segment does not meet it
constexpr double kSegmentEndShare = 1e-9;  ///< share of a segment's length by which its ends are extended

// The inferred boundary.
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

LaneBoundary::LaneBoundary(const std::vector<Point>& vertices, bool closed) : closed_(closed) {
    for (const Point& vertex : vertices) {
        if (vertices_.empty() || (vertex - vertices_.back()).norm() > kOnePlace_m)
            vertices_.push_back(vertex);
    }
    while (closed && vertices_.size() > 1 && (vertices_.back() - vertices_.front()).norm() <= kOnePlace_m) {
        vertices_.pop_back();
    }
    if (vertices_.size() < 2) closed_ = false;
    arc_m_.push_back(0.0);
    const std::size_t count = vertices_.size() - (closed_ ? 0 : 1);
    for (std::size_t i = 0; i < count; ++i) {
        const Segment s = segment(i);
        arc_m_.push_back(arc_m_.back() + (s.to - s.from).norm());
    }
}

template <typename Visit>
void LaneBoundary::for_segments_near(double place_m, double reach_m, const Visit& visit) const {
    const std::size_t count = segments();
    if (count == 0) return;
    if (closed_ && 2.0 * reach_m >= length_m()) {
        for (std::size_t i = 0; i < count; ++i) visit(i);
        return;
    }
    double from_m = place_m - reach_m;
    if (closed_) from_m -= length_m() * std::floor(from_m / length_m());
    const double to_m = from_m + 2.0 * reach_m;
    const auto after = std::upper_bound(arc_m_.begin() + 1, arc_m_.end() - 1, from_m);
    auto i = static_cast<std::size_t>(after - arc_m_.begin()) - 1;
    double turn_m = 0.0;
    while (arc_m_[i] + turn_m <= to_m) {
        visit(i);
        if (++i < count) continue;
        if (!closed_) return;
        i = 0;
        turn_m += length_m();
    }
}

double LaneBoundary::distance_m(const Point& query, double place_m, double reach_m) const {
    if (segments() == 0) return (query - vertices_.front()).norm();
    double min_m2 = std::numeric_limits<double>::infinity();
    for_segments_near(place_m, reach_m, [&](std::size_t i) {
        const Segment s = segment(i);
        const Point along = s.to - s.from;
        const Point to_query = query - s.from;
        const double share = std::clamp(to_query.dot(along) / along.squaredNorm(), 0.0, 1.0);
        min_m2 = std::min(min_m2, (to_query - share * along).squaredNorm());
    });
    return std::sqrt(min_m2);
}

std::optional<double> LaneBoundary::ray_hit_m(const Point& from, const Point& unit_direction, double place_m,
                                              double reach_m) const {
    std::optional<double> nearest_m;
    for_segments_near(place_m, reach_m, [&](std::size_t i) {
        const Segment s = segment(i);
        const Point along = s.to - s.from;
        const double sine = cross(unit_direction, along);
        if (std::abs(sine) <= kParallelSine * along.norm()) return;
        const Point to_segment = s.from - from;
        const double share = cross(to_segment, unit_direction) / sine;
        const double hit_m = cross(to_segment, along) / sine;
        if (share < -kSegmentEndShare || share > 1.0 + kSegmentEndShare || hit_m < 0.0) return;
        if (!nearest_m || hit_m < *nearest_m) nearest_m = hit_m;
    });
    return nearest_m;
}

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
