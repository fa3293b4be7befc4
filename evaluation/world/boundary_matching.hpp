#pragma once

#include "model/geometry.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace conelane {

/// Indices of positions on the left and on the right boundary that face each other.
struct FacingPlaces {
    std::size_t left;
    std::size_t right;
};

/// The monotone matching of two densely sampled boundaries with the least sum of squared distances between
/// matched positions (symmetric dynamic time warping: a step on both sides counts as one on each). Every
/// position is matched at least once, from the first pair to the last. Of equally good steps, one on both
/// sides comes first, then one on the left. Takes one byte for each pair of positions. Precondition: neither
/// boundary is empty.
[[nodiscard]] std::vector<FacingPlaces> match_boundaries(std::span<const Point> left,
                                                         std::span<const Point> right);

}  // namespace conelane
