#pragma once

#include "conelane/lane_detector.hpp"
#include "graph_search/front/front_search.hpp"

namespace conelane {

/// Cones that stand at most this far apart [m] are one cone for `front` in scenes that have many of them (see
/// DoubledCones). True cones of different boundaries stand metres apart, so at most cones of one boundary
/// become one, or a false cone stands for a true one beside it, within what a lane may be off.
inline constexpr double kFrontDoubledCone_m = 0.35;

struct FrontOptions {
    FrontWeights weights;
    FrontSearchOptions search;
    /// Score for each cone that the last answer had on the same side, see FrontEvidence. Absent: nothing is
    /// carried from scene to scene.
    std::optional<double> repeat_bonus = {};
};

/// The weights that come with the library, in the search that they were trained for.
[[nodiscard]] FrontOptions shipped_front_options();

/// The same with the last lane of a lap as evidence.
[[nodiscard]] FrontOptions warm_front_options();

/// Lane detection by one front: both boundaries grow together, one cone at a time, under a learned cost that
/// sees both of them, and a beam search finds the lanes of the highest score. FrontJudge takes the best of
/// them. A boundary may step over cones that were not seen. The far ends are evened (see even_far_ends); a
/// lane has two cones a side at least, each cone at most once. It is never closed: it ends where the course
/// comes back beside or behind the car, where no view that it has learned from shows cones.
///
/// Cone::position_covariance widens the rules of width and turn and shortens LaneAnswer::trusted_m. Where no
/// cone has one, or all are 0, the answer is that without.
///
/// LaneAnswer::confidence is the probability that the lane is usable: that it can be driven by for 20 m, or
/// to its end; LaneAnswer::trusted_m is how far it is right, with calibrated probability.
/// DetectionLimits::keep_candidates asks for the best lanes, kContenders of FrontJudge at most, each with its
/// confidence. Enumeration counts the states that moved, and says `complete` where no lane that the rules
/// allow was left out.
///
/// Where no lane was found before time or memory was spent, or none whose probability to be usable is 0.03, a
/// boundary is looked for that is seen alone (see BoundarySearch): three cones at least, five in place of a
/// lane, the other side of the answer empty, no confidence. The bonus of the last lane has no part in it, and
/// it is not remembered as one.
///
/// LaneAnswer::status: `none` where every lane that the rules allow was met and there is none, nor a boundary
/// alone; `stopped` by iterations where none was found but the beam left some out; `stopped_by` time or
/// memory is the best lane met until then. Once memory is warm, `detect` allocates the two boundaries of the
/// answer and nothing else. With FrontOptions::repeat_bonus the last lane that was found is carried from
/// scene to scene until `reset`; without it nothing is. Throws InvalidInput if an option is out of its
/// range.
[[nodiscard]] std::unique_ptr<LaneDetector> make_front_detector(const FrontOptions& options);

/// The cones of a lane without its far ends, as even_far_ends, on positions. Where kMaxLaneWidth_m would
/// leave no lane, which is a wide one, they may be apart a quarter more than its nearer half is. For training
/// too.
void even_far_ends(const FrontMap& map, std::array<std::vector<Vertex>, 2>& cones);

}  // namespace conelane
