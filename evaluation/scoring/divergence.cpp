#include "evaluation/scoring/divergence.hpp"

#include "conelane/invalid_input.hpp"
#include "model/geometry.hpp"

#include <algorithm>
#include <cmath>

namespace conelane {

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

}  // namespace conelane
