#pragma once

#include "conelane/lane_detector.hpp"
#include "evaluation/scoring/lane_iou.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "evaluation/world/annotated_scene.hpp"
#include "evaluation/world/track.hpp"

namespace conelane {

/// The stretch of a centre line over which lateral errors are taken [m].
inline constexpr double kCentreLineStretch_m = 20.0;
/// Length of centre lines [m]: poses that are farther apart have nothing in common.
inline constexpr double kCentreLineLength_m = kCentreLineStretch_m + 5.0;
/// Distance at which the heading error is taken [m].
inline constexpr double kHeadingAt_m = 10.0;
/// The stretch over which the centre lines of consecutive poses are compared [m].
inline constexpr double kSteadyStretch_m = 15.0;
/// Centre lines of consecutive poses that are within this distance everywhere are steady [m].
inline constexpr double kSteady_m = 0.5;
inline constexpr double kCentreLineStep_m = 0.5;

struct CentreLinePoint {
    Point position;
    double heading_rad;
};
/// From the car's foot point on, a point every kCentreLineStep_m; empty if a lane has no centre line.
using CentreLine = std::vector<CentreLinePoint>;

/// The first `length_m` of the centre line of a lane as a car would drive it (see `drivable`). Empty if the
/// lane cannot be driven, or a boundary is empty: inferred boundaries are not scored.
[[nodiscard]] CentreLine centre_line_of(const LaneOutline& outline, const Pose& pose,
                                        double length_m = kCentreLineLength_m);

/// The same for a polyline: resampled, from the foot point of the car on.
[[nodiscard]] CentreLine centre_line_of(std::span<const Point> polyline, const Pose& pose,
                                        double length_m = kCentreLineLength_m);

/// Distance of a lane's centre line from the true one.
struct CentreLineError {
    std::vector<float> lateral_m;       ///< at each point of the first kCentreLineStretch_m that both cover
    std::optional<double> heading_rad;  ///< at kHeadingAt_m; absent if one of the lines ends before
};
[[nodiscard]] CentreLineError centre_line_error(std::span<const CentreLinePoint> lane,
                                                std::span<const CentreLinePoint> truth);

/// Whether the centre line of a pose agrees with that of the pose before: over the first kSteadyStretch_m in
/// common, none of its points is farther than kSteady_m from the earlier line. False if they have nothing in
/// common, for example if one is empty.
[[nodiscard]] bool is_steady(std::span<const CentreLinePoint> before, std::span<const CentreLinePoint> now);

/// A lane that does not diverge is usable from this length on, or from kTooShortShare of the ground truth's.
inline constexpr double kUsableLength_m = 20.0;
/// A centre line farther from the true one than this has left it [m].
inline constexpr double kOffCentreLine_m = 1.0;
// Limits of the measures of the CLC paper, VIII-B.
inline constexpr double kCriticalDivergence_m = 20.0;  ///< below it a diverging lane is a critical failure
inline constexpr double kTooShortShare = 0.75;         ///< of the ground truth's length
inline constexpr double kNearGroundTruthIou = 0.98;    ///< of a candidate that counts as found
// Limits of the measures of the RLD paper, IV.
inline constexpr double kRldTimeLimit_ms = 400.0;
inline constexpr double kRldAbsoluteGap = 1e-5;
inline constexpr double kMinLaneWidth_m = 2.5;  ///< w_min; w_max is kMaxLaneWidth_m
inline constexpr std::size_t kAllowedConeDifference = 1;

/// The outcome of a detection: the first category that fits, in this order.
enum class Category {
    none,                ///< no lane found
    ground_truth,        ///< exactly the lane of the ground truth, also in `closed`
    diverging_below_20,  ///< critical
    diverging_from_20,
    too_short,
    near_ground_truth,  ///< all other lanes
};
inline constexpr std::size_t kCategoryCount = 6;
[[nodiscard]] std::string_view to_string(Category category);
/// True for all but none and diverging_below_20.
[[nodiscard]] bool is_success(Category category);
/// Whether a lane that was found can be driven by, see SceneScore::usable. `divergence_distance_m`: absent
/// where it does not diverge.
[[nodiscard]] bool is_usable(double lane_length_m, double ground_truth_length_m,
                             std::optional<double> divergence_distance_m);

/// The four quality checks behind "accurate" (RLD paper, IV-B).
struct Accuracy {
    /// (a) Selected cones that are not in the ground truth plus its cones that were missed, over both sides:
    /// at most one. A cone that is selected twice counts once.
    bool cones = false;
    bool sides = false;  ///< (b) the point of each boundary nearest the car is on its side, not on the axis
    bool crossings = false;  ///< (c) no two edges cross; touching is no crossing
    bool width = false;      ///< (d) boundaries at least w_min apart, no vertex beyond w_max of the other one

    [[nodiscard]] bool accurate() const { return cones && sides && crossings && width; }
};

struct EnumerationScore {
    std::int64_t iterations = 0;
    bool complete = false;
    std::optional<double> best_iou;  ///< among the candidates; absent if there are none
    std::optional<std::int64_t> first_near_ground_truth_iteration;  ///< first IoU >= kNearGroundTruthIou
};

/// The measures of one answer. All IoU, lengths and categories refer to the ground truth of the whole visible
/// scene, accuracy to that of the detector's own cone set.
struct SceneScore {
    Category category = Category::none;
    bool error = false;  ///< the detector failed, or the checker rejected what it found
    /// 0 if there is no lane; absent if the ground truth or the answer has no boundaries.
    std::optional<double> iou;
    double lane_length_m = 0.0;
    double ground_truth_length_m = 0.0;
    bool divergence_known = false;                ///< annotated boundaries, or the driven path, were given
    std::optional<double> divergence_distance_m;  ///< absent if the lane does not diverge or it is unknown
    std::optional<Accuracy> accuracy;             ///< absent if the cone set has no ground truth
    /// Within kRldTimeLimit_ms a gap of at most kRldAbsoluteGap, or the proof that there is no lane (which
    /// RecordScorer fills in); absent if the answer states no objective.
    std::optional<bool> solved_to_optimality;
    std::optional<EnumerationScore> enumeration;
    double latency_ms = 0.0;
    /// Against the ground truth's centre line; absent if the lane is not usable or not compared with
    /// it.
    std::optional<CentreLineError> centre_line_error;
    // The detector's statements about its lane; absent if it found none or makes none.
    std::optional<double> confidence;
    std::optional<double> trusted_m;
    bool trained_on = false;  ///< the detector has learned from the course
    /// Whether the centre line agrees with that of the pose before; absent at the first pose of a lap.
    std::optional<bool> steady;

    /// The headline: whether the lane can be driven by. It was found, does not diverge below 20 m, and, where
    /// it does not diverge at all, is at least min(kUsableLength_m, kTooShortShare of the ground truth's
    /// length) long. Absent if divergence is unknown.
    [[nodiscard]] std::optional<bool> usable() const;
    [[nodiscard]] bool success() const { return is_success(category); }
    [[nodiscard]] bool accurate() const { return accuracy && accuracy->accurate(); }
};

/// The positions of a lane's cones. Throws InvalidInput naming the key (`left[2]`) if a cone is not in the
/// scene.
[[nodiscard]] LaneOutline outline_of(const Lane& lane, const Scene& scene);

/// Whether a scene counts: it has a ground truth with at least two cones on each side, or it belongs to a run
/// whose driven path shows at least kMinDriven_m of the way ahead (see divergence.hpp).
[[nodiscard]] bool counts(const AnnotatedScene& scene, const TrackBoundaries* boundaries = nullptr);

/// Scores one answer by the measures of both papers. `nearest`: the detector saw only that many cones ahead,
/// and accuracy refers to the ground truth of these cones. `boundaries`: those of the scene's track; without
/// them, divergence is unknown, and a diverging lane gets another category.
///
/// A scene of a run without annotated boundaries is scored against the path that was driven: the lane
/// diverges where that path leaves it, and the ground truth's length is that of the path. IoU and accuracy
/// are absent.
///
/// An answer that is not found, or found with an empty side, has category none: a single boundary is not
/// scored as a lane, although a car may be able to use it. Ids that occur twice in a lane are scored as they
/// are.
/// Throws InvalidInput naming the key where the scene does not count, a lane or candidate names a cone that
/// is not in the scene, or the boundary of a side is empty.
[[nodiscard]] SceneScore score(const AnnotatedScene& scene, const LaneAnswer& answer, double latency_ms,
                               std::optional<std::size_t> nearest, const TrackBoundaries* boundaries);

/// The same for an answer of positions instead of cones. Category ground_truth needs ids, so an exact lane
/// has near_ground_truth; accuracy is absent.
[[nodiscard]] SceneScore score_outline(const AnnotatedScene& scene, const LaneOutline& lane,
                                       double latency_ms, const TrackBoundaries* boundaries);

/// The same for an answer that is only a centre line, its first point nearest to the car. It diverges where
/// it is more than kOffCentreLine_m from the centre line of the ground truth or the driven path, leaps along
/// it or goes back. Its length is how far it follows that line. IoU and accuracy are absent.
[[nodiscard]] SceneScore score_centre_line(const AnnotatedScene& scene, std::span<const Point> centre_line,
                                           double latency_ms, const TrackBoundaries* boundaries);

/// Means over scenes; shares are in [0, 1]. Failures count in every mean: a scene without a lane counts with
/// IoU 0, as not accurate and not steady. An answer without optimality, enumeration or candidates, if other
/// answers of the sample have them, counts as not solved, not complete, best IoU 0. A measure that no scene
/// has is absent.
struct ScoreSummary {
    std::size_t scenes = 0;
    std::size_t errors = 0;                               ///< scenes on which the detector failed
    std::size_t trained_on = 0;                           ///< scenes of courses it has learned from
    std::size_t divergence_unknown = 0;                   ///< scenes scored without annotated boundaries
    std::array<double, kCategoryCount> category_share{};  ///< indexed by Category
    std::optional<double> usable_share;                   ///< of the scenes whose divergence is known
    double success_share = 0.0;
    std::optional<double> mean_iou;            ///< of the scenes that have one
    std::optional<double> lateral_median_m;    ///< of all points of the first 20 m of usable lanes
    std::optional<double> lateral_p95_m;       ///< the same
    std::optional<double> heading_median_rad;  ///< at 10 m, of usable lanes
    std::optional<double> heading_p95_rad;     ///< the same
    std::optional<double> unsteady_share;      ///< of the poses that have one before them in their lap
    std::size_t accuracy_scenes = 0;           ///< scenes whose cone set holds a ground truth
    std::optional<double> accurate_share;      ///< of accuracy_scenes
    Calibration calibration;  ///< of the lanes with a statement of their detector and known divergence
    std::optional<double> solved_share;
    std::optional<double> complete_share;
    std::optional<double> best_candidate_mean_iou;
    std::optional<double> best_candidate_near_share;  ///< best IoU >= kNearGroundTruthIou
    LatencyStatistics latency;

    [[nodiscard]] double share(Category category) const {
        return category_share[static_cast<std::size_t>(category)];
    }
};
/// Throws InvalidInput if there is no score.
[[nodiscard]] ScoreSummary summarise(std::span<const SceneScore> scores);

}  // namespace conelane
