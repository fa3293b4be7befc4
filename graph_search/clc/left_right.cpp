#include "graph_search/clc/left_right.hpp"

#include <cmath>

namespace conelane {
namespace {

/// (cos, sin) of the absolute angle between two directions; (1, 0) if one has no length.
Point absolute_angle_on_circle(const Point& a, const Point& b) {
    const double lengths = std::sqrt(a.squaredNorm() * b.squaredNorm());
    if (lengths == 0.0) return {1.0, 0.0};
    return {a.dot(b) / lengths, std::abs(cross(a, b)) / lengths};
}

}  // namespace

double advance_deviation(const Point& left_last, const Point& left_direction, const Point& right_last,
                         const Point& right_direction) {
    const Point across = right_last - left_last;
    // Both angles lie in [0, pi], so the chord between them on the unit circle grows with their difference.
    return (absolute_angle_on_circle(left_direction, across) -
            absolute_angle_on_circle(right_direction, -across))
        .squaredNorm();
}

Side left_right_decision(const std::array<BoundaryTip, 2>& tips, Side tie) {
    const BoundaryTip& left = tips[kLeft];
    const BoundaryTip& right = tips[kRight];
    const double left_extended =
        advance_deviation(left.next, left.next - left.last, right.last, right.direction);
    const double right_extended =
        advance_deviation(left.last, left.direction, right.next, right.next - right.last);
    if (left_extended == right_extended) return tie;
    return left_extended < right_extended ? kLeft : kRight;
}

}  // namespace conelane
