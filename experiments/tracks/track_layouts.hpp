#pragma once

#include "experiments/tracks/rounded_path.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

/// The drawing of a generated track: its centre line, and how many cones of no boundary lie around.
struct TrackLayout {
    std::string name;
    bool closed;
    std::vector<Corner> centre_line;
    std::size_t stray_cones;
};

/// All layouts: the three topologies of the RLD paper (straight, circle, curvy), then closed circuits within
/// the limits of the Formula Student rules, of 200 to 500 m.
[[nodiscard]] std::span<const TrackLayout> track_layouts();

}  // namespace conelane::experiments
