#include "graph_search/clc/lane_closing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace conelane {
namespace {

Segment ring_segment(std::span<const Point> ring, std::size_t i) {
    return {ring[i], ring[(i + 1) % ring.size()]};
}

bool ends_near(std::span<const Point> ring, double d_max_m) {
    const double gap_m = (ring.back() - ring.front()).norm();
    return gap_m > 0.0 && gap_m <= d_max_m;
}

bool turns_allowed(std::span<const Point> ring, double phi_max_rad) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Segment in = ring_segment(ring, i);
        const Segment out = ring_segment(ring, (i + 1) % ring.size());
        if (std::abs(turning_angle(in.to - in.from, out.to - out.from)) >= phi_max_rad) return false;
    }
    return true;
}

bool is_simple(std::span<const Point> ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
        for (std::size_t j = i + 2; j < ring.size(); ++j) {
            if (i == 0 && j == ring.size() - 1) continue;
            if (segments_intersect(ring_segment(ring, i), ring_segment(ring, j))) return false;
        }
    }
    return true;
}

bool meet(std::span<const Point> a, std::span<const Point> b) {
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t j = 0; j < b.size(); ++j) {
            if (segments_intersect(ring_segment(a, i), ring_segment(b, j))) return true;
        }
    }
    return false;
}

/// Only for a point that is on no segment of the ring.
bool encloses(std::span<const Point> ring, const Point& point) {
    double winding_rad = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Segment segment = ring_segment(ring, i);
        winding_rad += turning_angle(segment.from - point, segment.to - point);
    }
    return std::abs(winding_rad) > std::numbers::pi;
}

}  // namespace

bool can_be_closed(std::span<const Point> left, std::span<const Point> right, double d_max_m,
                   const LaneBounds& bounds) {
    if (left.size() < 3 || right.size() < 3) return false;
    if (!ends_near(left, d_max_m) || !ends_near(right, d_max_m)) return false;
    for (const std::span<const Point> ring : {left, right}) {
        if (!turns_allowed(ring, bounds.phi_max_rad) || !is_simple(ring)) return false;
    }
    if (meet(left, right)) return false;
    if (!encloses(left, right.front()) && !encloses(right, left.front())) return false;
    const LaneWidths widths = lane_widths(left, right, true);
    const auto allowed = [&](double width_m) { return bounds.w_min_m < width_m && width_m < bounds.w_max_m; };
    return std::ranges::all_of(widths.of_vertex_m[kLeft], allowed) &&
           std::ranges::all_of(widths.of_vertex_m[kRight], allowed) &&
           std::ranges::all_of(widths.of_segment_m[kLeft], allowed) &&
           std::ranges::all_of(widths.of_segment_m[kRight], allowed);
}

}  // namespace conelane
