#pragma once

#include "evaluation/world/track.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace conelane {

/// Why `coordinate_m` is invalid for a cone (not finite, or beyond 10^7 m); empty if it is valid.
[[nodiscard]] std::string coordinate_fault(double coordinate_m);

/// Throws InputError naming `left` or `right` if a boundary has too few cones: a closed course needs three,
/// an open one two.
void require_enough_cones(const Track& track, const std::filesystem::path& file);

/// Two cones of one boundary within this distance [m] count as one.
inline constexpr double kDoubledTrackCone_m = 0.3;

/// The track without cones within kDoubledTrackCone_m of an earlier cone of the same boundary: the later one
/// is removed from the boundary and the map, and so are cones of no boundary that are known to repeat others.
[[nodiscard]] Track without_doubled_cones(Track track, const std::vector<std::size_t>& repeated = {});

}  // namespace conelane
