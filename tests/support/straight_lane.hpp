#pragma once

#include "conelane/scene.hpp"

namespace conelane::tests {

/// A straight lane of width 3.6 m along +x, a cone every 4 m from 1 m ahead of a car at the origin: left ids
/// 0, 2, ..., right ids 1, 3, ... The right cones stand a little farther ahead unless told otherwise.
inline Scene straight_lane(int cones_a_side, double right_ahead_m = 0.2, double spacing_m = 4.0) {
    Scene scene;
    for (int i = 0; i < cones_a_side; ++i) {
        scene.cones.push_back({2 * i, {1.0 + spacing_m * i, 1.8}});
        scene.cones.push_back({2 * i + 1, {1.0 + right_ahead_m + spacing_m * i, -1.8}});
    }
    return scene;
}

}  // namespace conelane::tests
