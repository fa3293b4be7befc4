#pragma once

#include "graph_search/lane_constraints.hpp"
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
};

/// CLC, Algorithm 1: lane detection by enumeration of path pairs. Answers the longest feasible lane (mean
/// length of both boundaries; of equally long ones, the one met first) with at least two cones a side.
/// Each starting pair but the last may use half of the iterations that are left. LaneAnswer::enumeration is
/// always there; `complete`: every starting pair tried was searched to its end.
/// Throws InvalidInput where an option is out of its range.
[[nodiscard]] std::unique_ptr<LaneDetector> make_clc_detector(const ClcOptions& options);

}  // namespace conelane
