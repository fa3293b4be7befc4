#pragma once

#include "conelane/point.hpp"

#include <cstddef>
#include <span>

namespace conelane {

/// Two lengths [m] closer than this count as equal, and so do a value and its limit; the only tolerance of
/// MinDist and End, equation (7).
inline constexpr double kTieTolerance = 1e-9;

/// z component of a x b; positive where b points to the left of a.
[[nodiscard]] inline double cross(const Point& a, const Point& b) {
    return a.x() * b.y() - a.y() * b.x();
}

/// Closed segment between two points; zero length is allowed.
struct Segment {
    Point from;
    Point to;
};

/// The point of a segment nearest to a query.
struct FootPoint {
    Point point;
    double parameter;   ///< position on the segment, 0 at `from`, 1 at `to`; 0 on a segment of zero length
    double distance_m;  ///< from the query
};
[[nodiscard]] FootPoint foot_point(const Point& query, const Segment& segment);

/// Smallest distance of two closed segments, and whether it is attained between an end of one and an end of
/// the other (End of equation (7)). A tie within kTieTolerance between a pair of ends and an interior point
/// counts as between ends; so do touching ends. Crossing and overlapping segments have distance 0.
struct SegmentDistance {
    double distance_m;
    bool between_ends;
};
[[nodiscard]] SegmentDistance segment_distance(const Segment& a, const Segment& b);

/// Whether two closed segments have a point in common; touching counts, and so does collinear overlap.
/// Exact in the signs of the orientation determinants, no tolerance.
[[nodiscard]] bool segments_intersect(const Segment& a, const Segment& b);

/// Whether the ends of each lie on both sides of the other's line, farther than kTieTolerance from it.
[[nodiscard]] bool segments_cross(const Segment& a, const Segment& b);

/// Angle at `middle` between the rays to `a` and `b`, in [0, pi] rad; straight on is pi. 0 if a ray has no
/// length.
[[nodiscard]] double interior_angle(const Point& a, const Point& middle, const Point& b);

/// Signed angle from direction `before` to direction `after`, in (-pi, pi] rad, positive to the left; 0 if a
/// direction has no length.
[[nodiscard]] double turning_angle(const Point& before, const Point& after);

/// Sum of the segment lengths [m]; a closed polyline includes the segment from the last vertex to the first.
[[nodiscard]] double polyline_length_m(std::span<const Point> vertices, bool closed = false);

/// The point of a polyline nearest to a query. Ties: the first one along the polyline.
struct PolylineFoot {
    Point point;
    std::size_t segment;  ///< index of the segment's first vertex; 0 if there is only one vertex
    double arc_length_m;  ///< along the polyline from its first vertex
    double distance_m;    ///< from the query
};
/// Precondition: at least one vertex.
[[nodiscard]] PolylineFoot foot_on_polyline(const Point& query, std::span<const Point> vertices,
                                            bool closed = false);

}  // namespace conelane
