#include "evaluation/scoring/divergence.hpp"

#include "conelane/invalid_input.hpp"
#include "model/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace conelane {
namespace {

/// Segment and foot point at which the path passes the car; nothing if it does not.
struct Pass {
    std::size_t segment;
    Point foot;
};
std::optional<Pass> pass_of(const Pose& pose, std::span<const Point> driven) {
    std::optional<Pass> nearest;
    double nearest_m = kOffDriven_m;
    for (std::size_t i = 0; i + 1 < driven.size(); ++i) {
        const Point way = driven[i + 1] - driven[i];
        if (std::abs(turning_angle(pose.heading(), way)) > std::numbers::pi / 3.0) continue;
        const FootPoint foot = foot_point(pose.position, {driven[i], driven[i + 1]});
        if (foot.distance_m >= nearest_m) continue;
        nearest_m = foot.distance_m;
        nearest = Pass{i, foot.point};
    }
    return nearest;
}

/// The path up to the last place with a seen cone beside it.
std::vector<Point> cut_where_no_cone_is_seen(const std::vector<Point>& ahead, const Scene& scene) {
    double seen_m = 0.0;
    for (const Cone& cone : scene.cones) {
        const PolylineFoot foot = foot_on_polyline(cone.position, ahead);
        if (foot.distance_m <= kConeBesideDriven_m) seen_m = std::max(seen_m, foot.arc_length_m);
    }
    std::vector<Point> cut{ahead.front()};
    double length_m = 0.0;
    for (std::size_t i = 1; i < ahead.size(); ++i) {
        const double way_m = (ahead[i] - ahead[i - 1]).norm();
        if (length_m + way_m > seen_m) {
            if (way_m > 0.0 && seen_m > length_m)
                cut.push_back(ahead[i - 1] + (seen_m - length_m) / way_m * (ahead[i] - ahead[i - 1]));
            break;
        }
        length_m += way_m;
        cut.push_back(ahead[i]);
    }
    return cut;
}

/// `side` is 1 for the left boundary, -1 for the right one.
std::optional<double> first_fault_m(std::span<const Point> boundary, bool closed,
                                    std::span<const Point> ahead, double side) {
    double first_m = std::numeric_limits<double>::infinity();
    const double length_m = polyline_length_m(ahead);
    for (const Point& vertex : boundary) {
        const PolylineFoot foot = foot_on_polyline(vertex, ahead);
        if (foot.arc_length_m <= 0.0 || foot.arc_length_m >= length_m) continue;
        const Point way = ahead[foot.segment + 1] - ahead[foot.segment];
        if (side * cross(way, vertex - ahead[foot.segment]) < 0.0)
            first_m = std::min(first_m, foot.arc_length_m);
    }
    const std::size_t edges = boundary.size() - (closed ? 0 : 1);
    double passed_m = 0.0;
    for (std::size_t i = 0; i + 1 < ahead.size(); ++i) {
        const Segment driven{ahead[i], ahead[i + 1]};
        for (std::size_t j = 0; j < edges; ++j) {
            if (segments_cross(driven, {boundary[j], boundary[(j + 1) % boundary.size()]}))
                first_m = std::min(first_m, passed_m);
        }
        passed_m += (driven.to - driven.from).norm();
    }
    if (std::isinf(first_m)) return std::nullopt;
    return first_m;
}

}  // namespace

std::optional<BoundaryDivergence> boundary_divergence(std::span<const Point> predicted,
                                                      std::span<const Point> annotated, bool closed,
                                                      const Point& first_ground_truth_cone) {
    if (predicted.empty()) return std::nullopt;
    if (annotated.empty()) throw InvalidInput("tracks", "an annotated boundary has no points");
    const double course_m = polyline_length_m(annotated, closed);
    // How far a foot point moved: on a closed course the smallest representative that is not below -back_m.
    const auto moved = [&](double from_m, double to_m, double back_m) {
        const double difference_m = to_m - from_m;
        if (!closed || course_m <= 0.0) return difference_m;
        return difference_m - course_m * std::floor((difference_m + back_m) / course_m);
    };

    const double start_m = foot_on_polyline(first_ground_truth_cone, annotated, closed).arc_length_m;
    double last_foot_m = start_m;
    double travelled_m = 0.0;  // from the first ground-truth cone to the last vertex's foot
    for (std::size_t i = 0; i < predicted.size(); ++i) {
        const double back_m = i == 0 ? kFirstFootBack_m : kFootBack_m;
        const double ahead_m = i == 0
                                   ? kFirstFootAhead_m
                                   : kFootPerChord * (predicted[i] - predicted[i - 1]).norm() + kFootAhead_m;
        const PolylineFoot foot = foot_on_polyline(predicted[i], annotated, closed);
        const double move_m = moved(last_foot_m, foot.arc_length_m, back_m);
        if (foot.distance_m > kOffBoundary_m || move_m < -back_m || move_m > ahead_m) {
            return BoundaryDivergence{std::max(0.0, travelled_m), i};
        }
        last_foot_m = foot.arc_length_m;
        travelled_m += move_m;
    }
    return std::nullopt;
}

std::optional<double> boundary_divergence_m(std::span<const Point> predicted,
                                            std::span<const Point> annotated, bool closed,
                                            const Point& first_ground_truth_cone) {
    const auto divergence = boundary_divergence(predicted, annotated, closed, first_ground_truth_cone);
    if (!divergence) return std::nullopt;
    return divergence->distance_m;
}

std::optional<double> divergence_m(const LaneOutline& predicted, const LaneOutline& ground_truth,
                                   const TrackBoundaries& annotated) {
    const std::optional<double> left =
        boundary_divergence_m(predicted.left, annotated.left, annotated.closed, ground_truth.left.front());
    const std::optional<double> right =
        boundary_divergence_m(predicted.right, annotated.right, annotated.closed, ground_truth.right.front());
    if (left && right) return std::min(*left, *right);
    return left ? left : right;
}

std::vector<Point> driven_ahead(const Scene& scene, std::span<const Point> driven,
                                std::optional<double> range_m) {
    const std::optional<Pass> pass = pass_of(scene.pose, driven);
    if (!pass) return {};
    std::vector<Point> ahead{pass->foot};
    for (std::size_t i = pass->segment + 1; i < driven.size(); ++i) {
        const Point from_car = driven[i] - scene.pose.position;
        const bool is_seen = from_car.dot(scene.pose.heading()) >= 0.0 &&
                             from_car.norm() <= range_m.value_or(std::numeric_limits<double>::infinity());
        if (!is_seen) break;
        if (driven[i] != ahead.back()) ahead.push_back(driven[i]);
    }
    return cut_where_no_cone_is_seen(ahead, scene);
}

std::optional<double> driven_divergence_m(const LaneOutline& lane, std::span<const Point> ahead) {
    if (ahead.size() < 2) return std::nullopt;
    std::optional<double> first_m;
    const auto look_at = [&](const std::vector<Point>& boundary, double side) {
        if (boundary.empty()) return;
        const std::optional<double> fault_m = first_fault_m(boundary, lane.closed, ahead, side);
        if (fault_m) first_m = std::min(first_m.value_or(*fault_m), *fault_m);
    };
    look_at(lane.left, 1.0);
    look_at(lane.right, -1.0);
    return first_m;
}

}  // namespace conelane
