#pragma once

#include "experiments/tracks/track.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace conelane::experiments {

/// The names that generate_track knows, in the order of the layouts.
[[nodiscard]] std::vector<std::string> generated_track_names();

/// A made-up track: cones on both sides of the layout's centre line, within the Formula Student rules. Lane 3
/// to 5 m wide, the width swelling along the lap; cones of one side at most 5 m apart, uneven, denser in
/// tight bends and a little off the ideal boundary. Left cones are blue, right ones yellow; stray ones are of
/// unknown colour and belong to no boundary. Coordinates are multiples of 0.1 mm, the same on any machine.
/// The track is named `name`, `name@seed` where the seed is not 0. Throws InvalidInput where the name is
/// unknown.
[[nodiscard]] Track generate_track(const std::string& name, std::uint64_t seed);

}  // namespace conelane::experiments
