#pragma once

#include "evaluation/world/track.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace conelane {

/// The names that generate_track knows: the fixed layouts of track_layouts, then those of drawn_layout_names.
[[nodiscard]] std::vector<std::string> generated_track_names();

/// A made-up track: cones on both sides of the layout's centre line. On the fixed layouts, within the Formula
/// Student rules: the lane 3 to 5 m wide, the width swelling along the lap; cones of one side at most 5 m
/// apart, uneven, denser in tight bends and a little off the ideal boundary. On the drawn ones lanes of 2.8
/// to 6 m, cones 1.5 to 6.3 m apart, legs 3 to 6 m from each other, and gates. Left cones are blue, right
/// ones yellow, those of gates orange; stray ones are of unknown color and belong to no boundary.
/// Coordinates are multiples of 0.1 mm, the same on any machine. The track is named `name`, `name@seed` where
/// the seed is not 0. Throws InvalidInput if the name is unknown.
[[nodiscard]] Track generate_track(const std::string& name, std::uint64_t seed);

}  // namespace conelane
