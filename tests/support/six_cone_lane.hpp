#pragma once

#include "conelane/scene.hpp"

namespace conelane::tests {

/// Two straight boundaries of three cones, 3.2 m apart along them, which is expected, and 3.5 m across unless
/// told otherwise. 0, 1, 3 and 4 are near the car at the origin, 2 and 5 are far. The right boundary may be
/// moved ahead.
///     0 ----- 1 ----- 2
/// car >
///     3 ----- 4 ----- 5
inline Scene six_cone_lane(double right_ahead_m = 0.0, double half_width_m = 1.75) {
    Scene scene;
    scene.id = "straight";
    for (const double x : {1.0, 4.2, 7.4})
        scene.cones.push_back({static_cast<ConeId>(scene.cones.size()), {x, half_width_m}});
    for (const double x : {1.0, 4.2, 7.4})
        scene.cones.push_back({static_cast<ConeId>(scene.cones.size()), {x + right_ahead_m, -half_width_m}});
    return scene;
}

}  // namespace conelane::tests
