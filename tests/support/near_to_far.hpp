#pragma once

#include "solvers/path_pair/bound/pair_relaxation.hpp"

namespace conelane::tests {

/// Both legs from the near cones to the far ones.
inline path_pair::LegSystem near_to_far(const path_pair::ArcGraph& graph) {
    path_pair::LegSystem system;
    for (int cone = 0; cone < graph.cone_count(); ++cone) {
        system.kinds[0].start.push_back(graph.near(cone) ? 1 : 0);
        system.kinds[0].end.push_back(graph.near(cone) ? 0 : 1);
    }
    return system;
}

}  // namespace conelane::tests
