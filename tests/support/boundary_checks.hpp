#pragma once

#include "model/geometry.hpp"
#include "tests/support/testing.hpp"

namespace conelane {

/// The segments of a polyline in order, with the closing one where it is closed.
inline std::vector<Segment> segments(const std::vector<Point>& vertices, bool closed) {
    std::vector<Segment> result;
    for (std::size_t i = 0; i + (closed ? 0 : 1) < vertices.size(); ++i)
        result.push_back({vertices[i], vertices[(i + 1) % vertices.size()]});
    return result;
}

/// Whether no two segments of a polyline meet but neighbours at their common vertex.
inline bool is_simple(const std::vector<Point>& vertices, bool closed) {
    const std::vector<Segment> all = segments(vertices, closed);
    for (std::size_t i = 0; i < all.size(); ++i) {
        for (std::size_t j = i + 2; j < all.size(); ++j) {
            if (closed && i == 0 && j + 1 == all.size()) continue;
            if (segments_intersect(all[i], all[j])) return false;
        }
    }
    return true;
}

/// Smallest distance between two polylines [m].
inline double clearance_m(const std::vector<Point>& a, const std::vector<Point>& b, bool closed) {
    double smallest_m = std::numeric_limits<double>::infinity();
    for (const Segment& one : segments(a, closed)) {
        for (const Segment& other : segments(b, closed))
            smallest_m = std::min(smallest_m, segment_distance(one, other).distance_m);
    }
    return smallest_m;
}

/// Distance of each vertex to the left of the boundary, negative to its right [m].
inline std::vector<double> left_offsets_m(const std::vector<Point>& vertices,
                                          const std::vector<Point>& boundary, bool closed) {
    const std::vector<Segment> all = segments(boundary, closed);
    std::vector<double> result;
    for (const Point& vertex : vertices) {
        const PolylineFoot foot = foot_on_polyline(vertex, boundary, closed);
        // At a corner the mean direction tells the sides apart, that of one segment does not.
        Point along(0.0, 0.0);
        for (const Segment& segment : all) {
            if (segment_distance(segment, {foot.point, foot.point}).distance_m < 1e-9)
                along += (segment.to - segment.from).normalized();
        }
        const double left = cross(along, vertex - boundary[foot.segment]) >= 0.0 ? 1.0 : -1.0;
        result.push_back(left * foot.distance_m);
    }
    return result;
}

}  // namespace conelane
