#pragma once

#include "evaluation/world/half_disc.hpp"

#include <span>
#include <vector>

#include <boost/random/mersenne_twister.hpp>

namespace conelane {

/// The wanted number of persistent points in view from one place.
struct PersistentView {
    HalfDisc view;
    double expected_points = 0.0;
};

/// Points drawn once in the world that `views` cover. Their density at a place is the mean of the densities
/// that the views containing it want, so each view is expected to hold about its number, exactly so if all
/// want the same. All views have one radius, that of the first.
[[nodiscard]] std::vector<Point> draw_persistent_points(std::span<const PersistentView> views,
                                                        boost::random::mt19937_64& random);

}  // namespace conelane
