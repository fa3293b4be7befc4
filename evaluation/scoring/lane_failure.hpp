#pragma once

#include "evaluation/scoring/score.hpp"

namespace conelane {

/// A step of the ground truth longer than this many times its median step is a gap.
inline constexpr double kGapPerMedianStep = 1.5;
/// A driven path that leaves the lane before this has left it at the start [m].
inline constexpr double kAtStart_m = 2.0;

/// Why a lane is not usable, decided at the first place where it leaves the truth.
///
/// Of a lane that diverges below 20 m that place is the first vertex that is off (see divergence.hpp), of
/// both sides the one with the smaller divergence distance, the left one where they are equal:
/// - wrong_start: it is the first vertex of its side;
/// - cone_skipped: it lies on its own boundary, ahead and within the ground truth's stretch, and the boundary
///   runs the same way there (within 90 degrees) as at the vertex before: cones between were left out;
/// - wrong_leg: it lies on an annotated boundary otherwise: of another leg, or one that the lane has passed;
/// - wrong_side: it lies on the other side's boundary, within the ground truth's stretch;
/// - false_cone: it lies on no annotated boundary, so it is a false positive.
/// To lie on a boundary is to be at most kOffBoundary_m away from it.
///
/// Of a lane that is too short but does not diverge it is where most of the missing length is, as the sum
/// over both sides: before its first vertices (wrong_start), between its vertices (cone_skipped: chords are
/// shorter than the boundary), or behind its last ones. There
/// - gap_not_bridged: the next step of the ground truth on a side is longer than kGapPerMedianStep times the
///   median step of the ground truth of both sides;
/// - stopped_early: it is not.
///
/// A lane compared with a driven path, and an answer that is only a centre line, have no boundaries to look
/// at: where they diverge the cause is wrong_start below kAtStart_m and leaves_path from there on, else
/// stopped_early.
enum class LaneFailure {
    error,          ///< the detector failed, or the checker rejected what it found
    nothing_found,  ///< no lane
    wrong_start,
    wrong_leg,
    wrong_side,
    false_cone,
    cone_skipped,
    gap_not_bridged,
    stopped_early,
    leaves_path,
};
inline constexpr std::size_t kLaneFailureCount = 10;
[[nodiscard]] std::string_view to_string(LaneFailure failure);

/// `score` is what score(), score_outline() or score_centre_line() said of the lane; `lane` is empty if
/// the answer has no boundaries. Nothing if the lane is usable or that is unknown. Precondition: the scene
/// counts.
[[nodiscard]] std::optional<LaneFailure> lane_failure(const AnnotatedScene& scene, const LaneOutline& lane,
                                                      const SceneScore& score,
                                                      const TrackBoundaries* boundaries);

}  // namespace conelane
