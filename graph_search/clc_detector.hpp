#pragma once

#include "graph_search/candidate_search.hpp"
#include "graph_search/lane_agreement.hpp"
#include "graph_search/ranking.hpp"
#include "model/lane_detector.hpp"

#include <cstddef>
#include <memory>

namespace conelane {

struct ClcOptions : CandidateSearchOptions {
    std::shared_ptr<const LaneRanking> ranking;  ///< none: the longest lane is the answer
    /// The answer is the one that agrees best with the others among so many of the highest scores, see
    /// LaneAgreement; at most LaneAgreement::kMostCandidates. 0: the highest score, as in the paper. Only
    /// with a ranking.
    std::size_t agreeing_candidates = 0;
    /// Each search after the first starts from the last answer, section IV-F, until `reset`.
    bool warm_start = false;
};

/// The search and the ranking of the paper: equation (3), the network on eight features.
[[nodiscard]] ClcOptions paper_clc_options();
/// The same algorithm with five things more: the first search follows a lane that a beam search by learned
/// scores finds, the next-vertex decider weighs distances, a second search follows where one is not complete,
/// the network sees all features, and of the candidates that it puts first the one is taken that agrees best
/// with the others. The network was trained to choose well among all of these: a lane that leaves
/// the track within 20 m costs as much as several whole lanes, so where the scene is ambiguous before that, a
/// shorter lane that is certain goes before a longer one that is not.
[[nodiscard]] ClcOptions extended_clc_options();
/// The first half of it.
[[nodiscard]] CandidateSearchOptions extended_search_options();

/// CLC, Algorithm 1: lane detection by enumeration of path pairs. Answers the feasible lane with at least two
/// cones a side that has the highest score of the ranking or agrees best with those that do, or without a
/// ranking the longest (mean length of both boundaries). Of equal ones, the one met first.
/// LaneAnswer::enumeration is always there; `complete`: every starting pair tried was searched to its end, as
/// far as width_backtracking follows lanes. With two guides or a second search a candidate may be there
/// twice, its vertices added in another order, on which features depend. Throws InvalidInput where an option
/// is out of its range.
[[nodiscard]] std::unique_ptr<LaneDetector> make_clc_detector(const ClcOptions& options);

}  // namespace conelane
