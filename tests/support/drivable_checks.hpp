#pragma once

#include "tests/support/boundary_checks.hpp"
#include "tests/support/drivable_courses.hpp"

#include <iterator>

namespace conelane::tests {

inline double sharpest(const DrivableLane& lane) {
    double most = 0.0;
    for (const DrivablePoint& point : lane.points) most = std::max(most, std::abs(point.curvature_1pm));
    return most;
}

inline bool all_finite(const DrivableLane& lane) {
    return std::isfinite(lane.length_m) && std::ranges::all_of(lane.points, [](const DrivablePoint& p) {
               return std::isfinite(p.s_m) && p.position.allFinite() && std::isfinite(p.heading_rad) &&
                      std::isfinite(p.curvature_1pm) && std::isfinite(p.width_left_m) &&
                      std::isfinite(p.width_right_m);
           });
}

/// Whether a point is inside outlines, by the number of intersections with a ray from it.
inline bool is_inside(const Point& point, const std::vector<Segment>& outlines) {
    bool inside = false;
    for (const Segment& side : outlines) {
        if ((side.from.y() > point.y()) == (side.to.y() > point.y())) continue;
        const double share = (point.y() - side.from.y()) / (side.to.y() - side.from.y());
        if (side.from.x() + share * (side.to.x() - side.from.x()) > point.x()) inside = !inside;
    }
    return inside;
}

/// Expects a valid centre line: equal steps along its heading, and no point or segment that touches a
/// boundary or leaves the lane.
inline void expect_drivable(const Course& course, const DrivableLane& lane, double step_m = 0.5) {
    ASSERT_GE(lane.points.size(), 2U);
    ASSERT_TRUE(all_finite(lane));
    const bool closed = course.lane.closed;
    const std::vector<Point> left = course.left();
    const std::vector<Point> right = course.right();
    std::vector<Segment> boundaries = segments(left, closed);
    std::ranges::copy(segments(right, closed), std::back_inserter(boundaries));
    // If one boundary ends, the part of the other one behind the next bend does not bound the lane.
    std::vector<Point> left_beside = left;
    std::vector<Point> right_beside = right;
    const auto drop_far = [&](std::vector<Point>& boundary, const Point& end) {
        Point far = boundary.back();
        while (!closed && boundary.size() > 1 && (boundary.back() - end).norm() > kMaxLaneWidth_m) {
            far = boundary.back();
            boundary.pop_back();
        }
        Point near = boundary.back();
        for (int i = 0; i < 40; ++i) {  // to where it is kMaxLaneWidth_m away
            const Point middle = 0.5 * (near + far);
            ((middle - end).norm() > kMaxLaneWidth_m ? far : near) = middle;
        }
        boundary.push_back(near);
    };
    if (polyline_length_m(left) > polyline_length_m(right)) {
        drop_far(left_beside, right.back());
    } else {
        drop_far(right_beside, left.back());
    }
    std::vector<Segment> outlines = segments(left_beside, closed);
    std::ranges::copy(segments(right_beside, closed), std::back_inserter(outlines));
    const std::vector<Segment> ends{{left_beside.front(), right_beside.front()},
                                    {left_beside.back(), right_beside.back()}};
    if (!closed) std::ranges::copy(ends, std::back_inserter(outlines));
    const double spacing_m = lane.closed ? lane.length_m / static_cast<double>(lane.points.size()) : step_m;
    EXPECT_NEAR(spacing_m, step_m, step_m * step_m / lane.length_m);
    if (!lane.closed) {
        EXPECT_GE(lane.length_m, lane.points.back().s_m);
        EXPECT_LT(lane.length_m, lane.points.back().s_m + step_m);
    }
    const std::vector<Point> line = mapped(lane.points, &DrivablePoint::position);
    for (std::size_t i = 0; i < line.size(); ++i) {
        const DrivablePoint& point = lane.points[i];
        EXPECT_NEAR(point.s_m, static_cast<double>(i) * spacing_m, 1e-9 * (1.0 + point.s_m));
        EXPECT_GT(point.width_left_m, 0.2) << i;
        EXPECT_GT(point.width_right_m, 0.2) << i;
        const bool at_end = !closed && std::ranges::any_of(ends, [&](const Segment& end) {
            return foot_point(point.position, end).distance_m < 0.3;
        });
        EXPECT_TRUE(at_end || is_inside(point.position, outlines)) << i;
    }
    for (std::size_t i = 0; i + (lane.closed ? 0 : 1) < line.size(); ++i) {
        const DrivablePoint& here = lane.points[i];
        const DrivablePoint& next = lane.points[(i + 1) % line.size()];
        const Segment step{here.position, next.position};
        EXPECT_NEAR((step.to - step.from).norm(), spacing_m, 0.02 * spacing_m) << i;
        const double turn = std::remainder(next.heading_rad - here.heading_rad, 2.0 * kPi);
        const double mean_1pm = 0.5 * (here.curvature_1pm + next.curvature_1pm);
        EXPECT_NEAR(turn, mean_1pm * spacing_m, 0.03) << i;
        const double way = std::atan2(step.to.y() - step.from.y(), step.to.x() - step.from.x());
        EXPECT_NEAR(std::remainder(way - here.heading_rad - 0.5 * turn, 2.0 * kPi), 0.0, 0.02) << i;
        for (const Segment& side : boundaries) EXPECT_FALSE(segments_intersect(step, side)) << i;
    }
}

}  // namespace conelane::tests
