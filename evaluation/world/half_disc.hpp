#pragma once

#include "model/geometry.hpp"

namespace conelane {

/// The closed half disc ahead of a car.
struct HalfDisc {
    Point centre;
    Point heading;
    double radius_m;

    [[nodiscard]] bool contains(const Point& point) const {
        const Point offset = point - centre;
        return heading.dot(offset) >= 0.0 && offset.squaredNorm() <= radius_m * radius_m;
    }
};

}  // namespace conelane
