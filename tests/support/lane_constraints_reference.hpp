#pragma once

#include "graph_search/clc/lane_constraints.hpp"
#include "tests/support/testing.hpp"

namespace conelane {

inline bool turns_allowed(std::span<const Point> boundary, double phi_max_rad) {
    for (std::size_t i = 2; i < boundary.size(); ++i) {
        const double turn = turning_angle(boundary[i - 1] - boundary[i - 2], boundary[i] - boundary[i - 1]);
        if (std::abs(turn) >= phi_max_rad) return false;
    }
    return true;
}

inline bool polygon_is_simple(std::span<const Point> left, std::span<const Point> right) {
    std::vector<Point> polygon(left.begin(), left.end());
    polygon.insert(polygon.end(), right.rbegin(), right.rend());
    const std::size_t n = polygon.size();
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 2; j < n; ++j) {
            if (i == 0 && j == n - 1) continue;
            if (segments_intersect({polygon[i], polygon[i + 1]}, {polygon[j], polygon[(j + 1) % n]})) {
                return false;
            }
        }
    }
    return true;
}

/// CD of equation (6) by its definition, for a lane of at least one point a side. C_poly: no two segments of
/// the lane polygon (l_1, ..., l_n, r_m, ..., r_1) that are not neighbours have a point in common.
inline bool satisfies_constraints(std::span<const Point> left, std::span<const Point> right,
                                  const LaneBounds& bounds) {
    if (!turns_allowed(left, bounds.phi_max_rad) || !turns_allowed(right, bounds.phi_max_rad)) return false;
    if (!polygon_is_simple(left, right)) return false;
    const LaneWidths widths = lane_widths(left, right);
    const auto allowed = [&](double width_m) { return bounds.w_min_m < width_m && width_m < bounds.w_max_m; };
    return std::ranges::all_of(widths.of_vertex_m[kLeft], allowed) &&
           std::ranges::all_of(widths.of_vertex_m[kRight], allowed) &&
           std::ranges::all_of(widths.of_segment_m[kLeft], allowed) &&
           std::ranges::all_of(widths.of_segment_m[kRight], allowed);
}

}  // namespace conelane
