#pragma once

#include "solvers/path_pair/search_tuning.hpp"

#include <cstdint>
#include <limits>

namespace conelane {

/// Stages of `path-pair`, and its numbers. The answer is the same with each stage off; it takes longer.
struct PathPairOptions {
    bool fix_arcs = true;            ///< drop arcs whose reduced-cost bound reaches the incumbent
    bool clique_multipliers = true;  ///< multipliers on cliques of incompatible edges, not on cones alone
    bool complete_walks = true;      ///< complete the relaxation's walks to incumbents
    bool search_windows = true;      ///< improve incumbents in small parts of a large graph
    bool search_frontiers =
        true;  ///< end nodes by the search on frontiers, not by branching to the last edge
    bool drop_dominated_edges = true;  ///< there, drop what every way up to a frontier, or on, excludes
    int root_steps = 150;              ///< most ascent steps at the root
    int node_steps = 30;               ///< and at each other node
    SearchTuning tuning = {};
    /// The search ends after so many counted steps of about a nanosecond, as if time had run out: a limit
    /// that is the same on every machine.
    std::int64_t max_work = std::numeric_limits<std::int64_t>::max();
};

}  // namespace conelane
