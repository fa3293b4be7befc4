#pragma once

#include "tests/support/testing.hpp"

namespace conelane::tests {

/// A scene with a cone at each place, numbered from 0; the car is at the origin and looks along +x.
inline Scene cones_at(const std::vector<Point>& places) {
    Scene scene;
    for (const Point& place : places) scene.cones.push_back({static_cast<ConeId>(scene.cones.size()), place});
    return scene;
}

/// Places at equal angles about the origin, the first one at `from_rad`; the last one is a step before
/// `from_rad + sector_rad`.
inline std::vector<Point> ring(double radius_m, int places, double from_rad = 0.0,
                               double sector_rad = 2.0 * std::numbers::pi) {
    std::vector<Point> all;
    for (int k = 0; k < places; ++k) {
        const double angle_rad = from_rad + sector_rad * k / places;
        all.emplace_back(radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad));
    }
    return all;
}

/// Two rings of 12 cones; the car is between them.
inline Scene circuit_seen_whole() {
    std::vector<Point> places;
    for (int i = 0; i < 12; ++i) {
        const double angle_rad = 2.0 * std::numbers::pi * (i + 0.3) / 12.0;
        for (const double radius_m : {6.0, 9.5})
            places.emplace_back(radius_m * std::sin(angle_rad), 7.75 - radius_m * std::cos(angle_rad));
    }
    return cones_at(places);
}

}  // namespace conelane::tests
