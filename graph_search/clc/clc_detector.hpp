#pragma once

#include "conelane/lane_detector.hpp"
#include "graph_search/clc/candidate_search.hpp"
#include "graph_search/clc/ranking.hpp"

namespace conelane {

struct ClcOptions : CandidateSearchOptions {
    std::shared_ptr<const LaneRanking> ranking;  ///< absent: the longest lane is the answer
    /// Each search after the first starts from the last answer, section IV-F, until `reset`.
    bool warm_start = false;
};

/// The search and the ranking of the paper: equation (3), the network on eight features.
[[nodiscard]] ClcOptions paper_clc_options();
/// The same algorithm with six additions: segments of up to 10 m, so a lane goes on past a missed cone; only
/// the 20 nearest neighbours of a cone may follow it; the first search follows the lane of a beam search by
/// learned scores; the next-vertex decider weighs distances; a second search follows if one is not complete;
/// the network sees all features. It was trained with a cost for unusable lanes, which leave the track within
/// 20 m or end before.
[[nodiscard]] ClcOptions extended_clc_options();
/// The search of these options, without the ranking.
[[nodiscard]] CandidateSearchOptions extended_search_options();

/// CLC, Algorithm 1: lane detection by enumeration of path pairs. The answer is the feasible lane with at
/// least two cones a side that has the highest score of the ranking; without a ranking, the longest lane
/// (mean length of both boundaries). Of equal lanes, the one met first.
///
/// LaneAnswer::status:
/// - found: `stopped_by` is absent if every starting pair tried was searched to its end. `iterations`: the
/// limit it_max ended a search, which is usual in a scene with many cones, and the same on every machine.
/// `time` or `memory`: the answer is the best lane so far.
///
/// - none: no candidate exists. Every pair of cones that a lane may start with, within start.largest_radius_m
/// of the car, was searched to its end, as far as width_backtracking follows lanes.
///
/// - stopped: nothing was found, but `stopped_by` ended the search, or there are more starting pairs than
/// starting_pairs (which counts as `iterations`).
///
/// - error: the scene or a limit is invalid; the message says why.
///
/// LaneAnswer::enumeration is present unless status is error; `complete`: every starting pair tried was
/// searched to its end. With two guides or a second search, a candidate may occur twice with its vertices
/// added in different orders, on which features depend. Without a warm start, an answer depends only on the
/// scene, the options and, if it is `stopped_by` time, the clock. Once memory is warm, `detect` allocates
/// only the two boundaries of the answer, except for kept candidates and lanes whose ends are near enough to
/// close.
///
/// Throws InvalidInput if an option is out of its range.
[[nodiscard]] std::unique_ptr<LaneDetector> make_clc_detector(const ClcOptions& options);

}  // namespace conelane
