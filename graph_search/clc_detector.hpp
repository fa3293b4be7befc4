#pragma once

#include "graph_search/lane_constraints.hpp"
#include "graph_search/ranking.hpp"
#include "graph_search/start_vertices.hpp"
#include "model/lane.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace conelane {

struct ClcOptions {
    std::int64_t iteration_limit = 2500;  ///< it_max, of all starting pairs together
    double d_max_m = 5.5;                 ///< largest distance of consecutive cones
    LaneBounds bounds;
    StartVertexRules start;          ///< its w_min_m and w_max_m are taken from `bounds`
    std::size_t starting_pairs = 3;  ///< how many are tried
    WidthBacktracking width_backtracking = WidthBacktracking::left_behind;
    std::shared_ptr<const LaneRanking> ranking;  ///< none: the longest lane is the answer
};

/// CLC, Algorithm 1: lane detection by enumeration of path pairs. Answers the feasible lane with at least two
/// cones a side that has the highest score of the ranking, or without one the longest (mean length of both
/// boundaries). Of equal ones, the one met first. Each starting pair but the last may use half of the
/// iterations that are left. LaneAnswer::enumeration is always there; `complete`: every starting pair tried
/// was searched to its end, as far as width_backtracking follows lanes. Throws InvalidInput where an option
/// is out of its range.
[[nodiscard]] std::unique_ptr<LaneDetector> make_clc_detector(const ClcOptions& options);

}  // namespace conelane
