#pragma once

#include "tests/support/testing.hpp"

namespace conelane::tests {

/// A gently bent lane of up to `cones` cones ahead of a car at the origin, with noise, and about a third of
/// the cones strewn at random.
inline Scene random_scene(std::uint64_t seed, std::size_t cones) {
    boost::random::mt19937_64 random(seed);
    const auto uniform = [&](double low, double high) {
        return boost::random::uniform_real_distribution<double>(low, high)(random);
    };
    const double curvature = uniform(-0.08, 0.08);
    const double half_width = uniform(1.4, 2.4);
    const double spacing = uniform(2.0, 4.0);
    Scene scene;
    scene.id = "random_" + std::to_string(seed);
    scene.pose.yaw_rad = uniform(-3.0, 3.0);
    const Point ahead = scene.pose.heading();
    const Point left(-ahead.y(), ahead.x());
    for (std::size_t i = 0; i < cones; ++i) {
        double x = uniform(0.0, 14.0);
        double y = uniform(-7.0, 7.0);
        if (uniform(0.0, 1.0) > 0.33) {
            const double side = i % 2 == 0 ? 1.0 : -1.0;
            x = 1.0 + spacing * static_cast<double>(i / 2) + uniform(-0.4, 0.4);
            y = 0.5 * curvature * x * x + side * half_width + uniform(-0.3, 0.3);
        }
        scene.cones.push_back({static_cast<ConeId>(100 + i), x * ahead + y * left});
    }
    return scene;
}

/// Cones anywhere in a rectangle that begins at the car: the car looks along +x, from the middle of one side.
inline Scene strewn_scene(std::size_t cones, double ahead_m, double across_m, std::uint64_t seed = 7,
                          const Point& car = {0.0, 0.0}) {
    boost::random::mt19937_64 random(seed);
    boost::random::uniform_real_distribution<double> ahead(0.0, ahead_m);
    boost::random::uniform_real_distribution<double> left(-0.5 * across_m, 0.5 * across_m);
    Scene scene;
    scene.id = "strewn_" + std::to_string(seed);
    scene.pose.position = car;
    for (std::size_t i = 0; i < cones; ++i) {
        const double x_m = ahead(random);
        scene.cones.push_back({static_cast<ConeId>(i), car + Point(x_m, left(random))});
    }
    return scene;
}

}  // namespace conelane::tests
