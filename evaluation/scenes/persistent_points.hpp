#pragma once

#include "evaluation/scenes/half_disc.hpp"

#include <span>
#include <vector>

#include <boost/random/mersenne_twister.hpp>

namespace conelane {

/// What a car is to see of the points that persist along a lap, from one place of it.
struct PersistentView {
    HalfDisc view;
    double expected_points = 0.0;
};

/// Points drawn once in the world that `views` cover. Their density at a place is the mean of what the views
/// that contain it ask for, so each view is expected to hold about what it asks for, exactly where all ask
/// for the same. All views have one radius, the first one's.
[[nodiscard]] std::vector<Point> draw_persistent_points(std::span<const PersistentView> views,
                                                        boost::random::mt19937_64& random);

}  // namespace conelane
