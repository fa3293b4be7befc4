#pragma once

#include "conelane/lane_graph_problem.hpp"

namespace conelane::tests {

/// A straight lane, cones 0, 2, 4, 6 on the left, 1, 3, 5, 7 on the right: along each boundary, a path can
/// only go cone by cone.
inline LaneGraphProblem straight_lane_problem() {
    Scene scene;
    for (int row = 0; row < 4; ++row) {
        for (const double side : {2.5, -2.5}) {
            const auto id = static_cast<ConeId>(scene.cones.size());
            scene.cones.push_back({id, Point(2.0 + 4.0 * row, side)});
        }
    }
    return make_problem(scene, {});
}

}  // namespace conelane::tests
