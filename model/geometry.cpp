#include "model/geometry.hpp"

#include <cassert>
#include <numbers>

namespace conelane {
namespace {

/// Sign of the area of the triangle (a, b, c): positive where c lies left of the line from a to b.
double orientation(const Point& a, const Point& b, const Point& c) {
    return cross(b - a, c - a);
}

bool within_box(const Point& p, const Segment& s) {
    return std::min(s.from.x(), s.to.x()) <= p.x() && p.x() <= std::max(s.from.x(), s.to.x()) &&
           std::min(s.from.y(), s.to.y()) <= p.y() && p.y() <= std::max(s.from.y(), s.to.y());
}

}  // namespace

FootPoint foot_point(const Point& query, const Segment& segment) {
    const Point direction = segment.to - segment.from;
    const double squared_length = direction.squaredNorm();
    double parameter = 0.0;
    if (squared_length > 0.0) {
        parameter = std::clamp((query - segment.from).dot(direction) / squared_length, 0.0, 1.0);
    }
    const Point point = segment.from + parameter * direction;
    return {point, parameter, (query - point).norm()};
}

SegmentDistance segment_distance(const Segment& a, const Segment& b) {
    const double ends = std::sqrt(std::min({(a.from - b.from).squaredNorm(), (a.from - b.to).squaredNorm(),
                                            (a.to - b.from).squaredNorm(), (a.to - b.to).squaredNorm()}));
    double distance = 0.0;
    if (!segments_intersect(a, b)) {
        // If two segments do not cross, an end of one of them is nearest.
        distance = std::min({foot_point(a.from, b).distance_m, foot_point(a.to, b).distance_m,
                             foot_point(b.from, a).distance_m, foot_point(b.to, a).distance_m});
    }
    return {distance, ends <= distance + kTieTolerance};
}

bool segments_intersect(const Segment& a, const Segment& b) {
    const double from_side = orientation(a.from, a.to, b.from);
    const double to_side = orientation(a.from, a.to, b.to);
    const double a_from_side = orientation(b.from, b.to, a.from);
    const double a_to_side = orientation(b.from, b.to, a.to);
    if (((from_side > 0.0 && to_side < 0.0) || (from_side < 0.0 && to_side > 0.0)) &&
        ((a_from_side > 0.0 && a_to_side < 0.0) || (a_from_side < 0.0 && a_to_side > 0.0))) {
        return true;
    }
    return (from_side == 0.0 && within_box(b.from, a)) || (to_side == 0.0 && within_box(b.to, a)) ||
           (a_from_side == 0.0 && within_box(a.from, b)) || (a_to_side == 0.0 && within_box(a.to, b));
}

bool segments_cross(const Segment& a, const Segment& b) {
    const auto ends_apart = [](const Segment& line, const Segment& ends) {
        const double from_side = orientation(line.from, line.to, ends.from);
        const double to_side = orientation(line.from, line.to, ends.to);
        const double tie = kTieTolerance * (line.to - line.from).norm();
        return std::min(from_side, to_side) < -tie && std::max(from_side, to_side) > tie;
    };
    return ends_apart(a, b) && ends_apart(b, a);
}

double interior_angle(const Point& a, const Point& middle, const Point& b) {
    const Point to_a = a - middle;
    const Point to_b = b - middle;
    return std::atan2(std::abs(cross(to_a, to_b)), to_a.dot(to_b));
}

double turning_angle(const Point& before, const Point& after) {
    const double angle = std::atan2(cross(before, after), before.dot(after));
    // A sine of -0 or nearly 0 may give -pi, which is outside the half-open range.
    return angle <= -std::numbers::pi ? std::numbers::pi : angle;
}

double polyline_length_m(std::span<const Point> vertices, bool closed) {
    double length = 0.0;
    for (std::size_t i = 1; i < vertices.size(); ++i) length += (vertices[i] - vertices[i - 1]).norm();
    if (closed && vertices.size() > 1) length += (vertices.front() - vertices.back()).norm();
    return length;
}

PolylineFoot foot_on_polyline(const Point& query, std::span<const Point> vertices, bool closed) {
    assert(!vertices.empty());
    PolylineFoot best{vertices.front(), 0, 0.0, (query - vertices.front()).norm()};
    double travelled = 0.0;
    const std::size_t segments = vertices.size() - 1 + (closed && vertices.size() > 1 ? 1 : 0);
    for (std::size_t i = 0; i < segments; ++i) {
        const Segment segment{vertices[i], vertices[(i + 1) % vertices.size()]};
        const FootPoint foot = foot_point(query, segment);
        const double length = (segment.to - segment.from).norm();
        if (foot.distance_m < best.distance_m) {
            best = {foot.point, i, travelled + foot.parameter * length, foot.distance_m};
        }
        travelled += length;
    }
    return best;
}

}  // namespace conelane
