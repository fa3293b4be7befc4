#pragma once

#include "conelane/scene.hpp"

#include <vector>

namespace conelane::tests {

/// A scene with a cone at each place, numbered from 0; the car is at the origin and looks along +x.
inline Scene cones_at(const std::vector<Point>& places) {
    Scene scene;
    for (const Point& place : places) scene.cones.push_back({static_cast<ConeId>(scene.cones.size()), place});
    return scene;
}

}  // namespace conelane::tests
