#pragma once

#include "experiments/scenes/annotated_scene.hpp"
#include "experiments/scoring/statistics.hpp"
#include "experiments/tracks/track_boundaries.hpp"
#include "model/lane_detector.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace conelane::experiments {

// Measures of the CLC paper, VIII-B.
inline constexpr double kCriticalDivergence_m = 20.0;  ///< below it a diverging lane is a critical failure
inline constexpr double kTooShortShare = 0.75;         ///< of the ground truth's length
inline constexpr double kNearGroundTruthIou = 0.98;    ///< of a candidate that counts as found
// Measures of the RLD paper, IV.
inline constexpr double kRldTimeLimit_ms = 400.0;
inline constexpr double kRldAbsoluteGap = 1e-5;
inline constexpr double kNarrowestLane_m = 2.5;  ///< w_min; w_max is kWidestLane_m
inline constexpr std::size_t kAllowedConeDifference = 1;

/// What became of a detection: the first that fits in this order.
enum class Category {
    none,                ///< no lane found
    ground_truth,        ///< the very lane of the ground truth, closedness included
    diverging_below_20,  ///< critical
    diverging_from_20,
    too_short,
    near_ground_truth,  ///< the rest
};
inline constexpr std::size_t kCategoryCount = 6;
[[nodiscard]] std::string_view to_string(Category category);
/// All but none and diverging_below_20.
[[nodiscard]] bool is_success(Category category);

/// The four quality checks behind "accurate" (RLD paper, IV-B).
struct Accuracy {
    /// (a) Cones chosen that are not in the ground truth plus cones of it that were missed, both sides taken
    /// together: at most one. A cone chosen twice counts once.
    bool cones = false;
    bool sides = false;  ///< (b) the point of each boundary nearest the car is on its side, not on the axis
    bool crossings = false;  ///< (c) no two edges cross; touching is no crossing
    bool width = false;      ///< (d) boundaries at least w_min apart, no vertex beyond w_max of the other one

    [[nodiscard]] bool accurate() const { return cones && sides && crossings && width; }
};

struct EnumerationScore {
    std::int64_t iterations = 0;
    bool complete = false;
    std::optional<double> best_iou;  ///< among the candidates; absent where there are none
    std::optional<std::int64_t> first_near_ground_truth_iteration;  ///< first IoU >= kNearGroundTruthIou
};

/// The measures of one answer. All IoU, lengths and categories refer to the ground truth of all that is
/// visible, accuracy to that of the method's own cone set.
struct SceneScore {
    Category category = Category::none;
    bool error = false;  ///< the method failed, or the checker rejected what it found
    double iou = 0.0;    ///< 0 where there is no lane
    double lane_length_m = 0.0;
    double ground_truth_length_m = 0.0;
    bool divergence_known = false;                ///< annotated boundaries were given
    std::optional<double> divergence_distance_m;  ///< absent where the lane does not diverge or it is unknown
    std::optional<Accuracy> accuracy;             ///< absent where the cone set holds no ground truth
    /// Solved within kRldTimeLimit_ms with an absolute gap of at most kRldAbsoluteGap; absent where the
    /// answer states no objective.
    std::optional<bool> solved_to_optimality;
    std::optional<EnumerationScore> enumeration;
    double latency_ms = 0.0;

    [[nodiscard]] bool success() const { return is_success(category); }
    [[nodiscard]] bool accurate() const { return accuracy && accuracy->accurate(); }
};

/// Whether a scene counts: it has a ground truth with at least two cones on each side.
[[nodiscard]] bool counts(const AnnotatedScene& scene);

/// Scores one answer by both papers' measures. `nearest`: the method saw only that many cones ahead, and
/// accuracy is held against the ground truth of those. `boundaries`: of the scene's track; without them
/// divergence is unknown, no category is diverging and such lanes fall to too_short and near_ground_truth.
///
/// An answer that is not found, or found without any cone, is category none. Ids that repeat in a lane are
/// scored as they stand.
/// Throws InvalidInput naming the key where the scene does not count, a lane or candidate names a cone that
/// is not in the scene, or the boundary of a side is empty.
[[nodiscard]] SceneScore score(const AnnotatedScene& scene, const LaneAnswer& answer, double latency_ms,
                               std::optional<std::size_t> nearest, const TrackBoundaries* boundaries);

/// Means over scenes; shares are in [0, 1]. No failure leaves a mean: a scene without a lane counts with IoU
/// 0 and as not accurate, and an answer without optimality, enumeration or candidates, where others of the
/// sample have them, as not solved, not complete, best IoU 0. A measure that no scene has is absent.
struct ScoreSummary {
    std::size_t scenes = 0;
    std::size_t errors = 0;                               ///< scenes on which the method failed
    std::size_t divergence_unknown = 0;                   ///< scenes scored without annotated boundaries
    std::array<double, kCategoryCount> category_share{};  ///< indexed by Category
    double success_share = 0.0;
    double mean_iou = 0.0;
    std::size_t accuracy_scenes = 0;       ///< scenes whose cone set holds a ground truth
    std::optional<double> accurate_share;  ///< of accuracy_scenes
    std::optional<double> solved_share;
    std::optional<double> complete_share;
    std::optional<double> best_candidate_mean_iou;
    std::optional<double> best_candidate_near_share;  ///< best IoU >= kNearGroundTruthIou
    LatencyStatistics latency;

    [[nodiscard]] double share(Category category) const {
        return category_share[static_cast<std::size_t>(category)];
    }
};
/// Throws InvalidInput where there is nothing to summarise.
[[nodiscard]] ScoreSummary summarise(std::span<const SceneScore> scores);

}  // namespace conelane::experiments
