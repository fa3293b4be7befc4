#include "evaluation/scoring/lane_failure.hpp"

#include "evaluation/scoring/divergence.hpp"

namespace conelane {
namespace {

/// One side of a lane and the side that it is compared with.
struct Side {
    std::span<const Point> lane;
    std::span<const Point> truth;
    std::span<const Point> annotated;
    bool closed;  ///< whether the annotated boundary is closed

    [[nodiscard]] PolylineFoot foot(const Point& point) const {
        return foot_on_polyline(point, annotated, closed);
    }
    /// Along the boundary from the first ground-truth cone; on a closed boundary from -kFirstFootBack_m on.
    [[nodiscard]] double place_m(const PolylineFoot& of) const {
        const double place_m = of.arc_length_m - foot(truth.front()).arc_length_m;
        const double course_m = polyline_length_m(annotated, closed);
        if (!closed || course_m <= 0.0) return place_m;
        return place_m - course_m * std::floor((place_m + kFirstFootBack_m) / course_m);
    }
    [[nodiscard]] double truth_end_m() const { return place_m(foot(truth.back())); }
    [[nodiscard]] bool is_in_truth(const PolylineFoot& of) const {
        constexpr double kRounding_m = 1e-6;
        const double at_m = place_m(of);
        return at_m >= -kFirstFootBack_m && at_m <= truth_end_m() + kRounding_m;
    }
    [[nodiscard]] Point way_at(const PolylineFoot& of) const {
        const Point& next = annotated[(of.segment + 1) % annotated.size()];
        return next - annotated[of.segment];
    }
};

LaneFailure failure_at(const Side& side, const Side& other, std::size_t vertex_off) {
    if (vertex_off == 0) return LaneFailure::wrong_start;
    const Point& off = side.lane[vertex_off];
    const PolylineFoot own = side.foot(off);
    if (own.distance_m <= kOffBoundary_m) {
        const PolylineFoot before = side.foot(side.lane[vertex_off - 1]);
        const bool is_ahead = side.place_m(own) > side.place_m(before);
        if (is_ahead && side.is_in_truth(own) && side.way_at(before).dot(side.way_at(own)) > 0.0)
            return LaneFailure::cone_skipped;
        return LaneFailure::wrong_leg;
    }
    const PolylineFoot across = other.foot(off);
    if (across.distance_m > kOffBoundary_m) return LaneFailure::false_cone;
    return other.is_in_truth(across) ? LaneFailure::wrong_side : LaneFailure::wrong_leg;
}

/// Length of one side's ground truth that the lane does not cover, by place.
struct Missing {
    double before_m = 0.0;
    double between_m = 0.0;
    double behind_m = 0.0;
    double next_step_m = 0.0;  ///< next step of the truth after the lane; 0 if none
};

Missing missing_of(const Side& side) {
    const auto place = [&](const Point& point) {
        return std::clamp(side.place_m(side.foot(point)), 0.0, side.truth_end_m());
    };
    Missing missing;
    if (side.lane.empty()) {
        missing.before_m = side.truth_end_m();
        return missing;
    }
    const double first_m = place(side.lane.front());
    const double last_m = place(side.lane.back());
    missing.before_m = first_m;
    missing.between_m = std::max(0.0, last_m - first_m - polyline_length_m(side.lane));
    missing.behind_m = side.truth_end_m() - last_m;
    // A cone's position is the same in lane and ground truth, so the next cone is farther.
    constexpr double kSameCone_m = 0.05;
    const auto next = std::ranges::find_if(
        side.truth, [&](const Point& cone) { return place(cone) > last_m + kSameCone_m; });
    if (next != side.truth.end()) missing.next_step_m = (*next - side.lane.back()).norm();
    return missing;
}

double median_step_m(std::span<const Point> left, std::span<const Point> right) {
    std::vector<double> steps_m;
    for (const std::span<const Point> boundary : {left, right}) {
        for (std::size_t i = 1; i < boundary.size(); ++i)
            steps_m.push_back((boundary[i] - boundary[i - 1]).norm());
    }
    return median(steps_m);
}

LaneFailure failure_of_a_short_lane(const Side& left, const Side& right) {
    const Missing on_left = missing_of(left);
    const Missing on_right = missing_of(right);
    const double before_m = on_left.before_m + on_right.before_m;
    const double between_m = on_left.between_m + on_right.between_m;
    const double behind_m = on_left.behind_m + on_right.behind_m;
    if (before_m > std::max(between_m, behind_m)) return LaneFailure::wrong_start;
    if (between_m > behind_m) return LaneFailure::cone_skipped;
    const double gap_m = kGapPerMedianStep * median_step_m(left.truth, right.truth);
    return std::max(on_left.next_step_m, on_right.next_step_m) > gap_m ? LaneFailure::gap_not_bridged
                                                                       : LaneFailure::stopped_early;
}

LaneFailure failure_beside_boundaries(const LaneOutline& lane, const LaneOutline& truth,
                                      const TrackBoundaries& track) {
    const Side left{lane.left, truth.left, track.left, track.closed};
    const Side right{lane.right, truth.right, track.right, track.closed};
    const auto off_left = boundary_divergence(left.lane, left.annotated, left.closed, left.truth.front());
    const auto off_right =
        boundary_divergence(right.lane, right.annotated, right.closed, right.truth.front());
    if (off_left && (!off_right || off_left->distance_m <= off_right->distance_m))
        return failure_at(left, right, off_left->vertex_off);
    if (off_right) return failure_at(right, left, off_right->vertex_off);
    return failure_of_a_short_lane(left, right);
}

}  // namespace

std::string_view to_string(LaneFailure failure) {
    constexpr std::array<std::string_view, kLaneFailureCount> kNames{
        "error",      "nothing_found", "wrong_start",     "wrong_leg",     "wrong_side",
        "false_cone", "cone_skipped",  "gap_not_bridged", "stopped_early", "leaves_path"};
    return kNames[static_cast<std::size_t>(failure)];
}

std::optional<LaneFailure> lane_failure(const AnnotatedScene& scene, const LaneOutline& lane,
                                        const SceneScore& score, const TrackBoundaries* boundaries) {
    if (score.usable().value_or(true) || boundaries == nullptr) return std::nullopt;
    if (score.error) return LaneFailure::error;
    if (score.category == Category::none) return LaneFailure::nothing_found;
    const bool has_truth = scene.ground_truth && scene.ground_truth->left.size() >= 2 &&
                           scene.ground_truth->right.size() >= 2 && !boundaries->left.empty() &&
                           !boundaries->right.empty();
    if (has_truth && !(lane.left.empty() && lane.right.empty()))
        return failure_beside_boundaries(lane, outline_of(*scene.ground_truth, scene.scene), *boundaries);
    if (!score.divergence_distance_m) return LaneFailure::stopped_early;
    return *score.divergence_distance_m < kAtStart_m ? LaneFailure::wrong_start : LaneFailure::leaves_path;
}

}  // namespace conelane
