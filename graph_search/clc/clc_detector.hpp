#pragma once

#include "conelane/lane_detector.hpp"
#include "graph_search/clc/candidate_search.hpp"
#include "graph_search/clc/ranking.hpp"

#include <memory>

namespace conelane {

struct ClcOptions : CandidateSearchOptions {
    std::shared_ptr<const LaneRanking> ranking;  ///< none: the longest lane is the answer
    /// Each search after the first starts from the last answer, section IV-F, until `reset`.
    bool warm_start = false;
};

/// The search and the ranking of the paper: equation (3), the network on eight features.
[[nodiscard]] ClcOptions paper_clc_options();
/// The same algorithm with five additions: segments may be 10 m long, so that a lane goes on past a cone that
/// was missed; the first search follows the lane of a beam search by learned scores; the next-vertex decider
/// weighs distances; where a search is not complete a second one follows; the network sees all features. It
/// was trained with a cost for lanes that cannot be driven by, whether they leave the track within 20 m or
/// end before.
[[nodiscard]] ClcOptions extended_clc_options();
/// The search of these, without the ranking.
[[nodiscard]] CandidateSearchOptions extended_search_options();

/// CLC, Algorithm 1: lane detection by enumeration of path pairs. Answers the feasible lane with at least two
/// cones a side that has the highest score of the ranking, or without a ranking the longest (mean length of
/// both boundaries). Of equal ones, the one met first.
///
/// LaneAnswer::status:
/// - found: `stopped_by` is absent where every starting pair tried was searched to its end. `iterations`: the
///   limit it_max ended a search, the usual end in a scene with many cones, and the same on every machine.
///   `time` or `memory`: the answer is the best of what was found until then.
/// - none: no candidate exists. Every pair of cones that a lane may start with, within start.largest_radius_m
/// of
///   the car, was searched to its end, as far as width_backtracking follows lanes.
/// - stopped: nothing was found, but `stopped_by` ended the search, or there are more starting pairs than
///   starting_pairs (which counts as `iterations`).
/// - error: the scene or a limit is not valid, the message says why.
///
/// LaneAnswer::enumeration is there unless status is error; `complete`: every starting pair tried was
/// searched to its end. With two guides or a second search a candidate may be there twice, its vertices added
/// in another order, on which features depend. Without a warm start an answer depends on nothing but the
/// scene, the options and, where it is `stopped_by` time, the clock. Once memory is warm, `detect` allocates
/// the two boundaries of the answer and nothing else; two exceptions: kept candidates, and lanes whose ends
/// are near enough to close.
///
/// Throws InvalidInput where an option is out of its range.
[[nodiscard]] std::unique_ptr<LaneDetector> make_clc_detector(const ClcOptions& options);

}  // namespace conelane
