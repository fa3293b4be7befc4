#pragma once

#include "evaluation/world/rounded_path.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace conelane {

/// Width of a lane and arrangement of its cones.
struct TrackStyle {
    double mean_width_m = 4.0;
    double slow_swell_m = 0.5;             ///< amplitude of the width's two or three swells a lap
    double quick_swell_m = 0.25;           ///< amplitude of its five to eight swells a lap
    double lateral_jitter_m = 0.08;        ///< of a cone off the ideal boundary
    double widest_spacing_m = 4.05;        ///< expected on straights
    double spacing_per_curvature_m = 5.0;  ///< a bend of this radius halves the spacing
    /// Gates: a pair of big orange cones on each side, in a gap of the boundaries.
    std::size_t gates = 0;
};

/// The drawing of a generated track: its centre line, and the number of cones of no boundary around it.
struct TrackLayout {
    std::string name;
    bool closed;
    std::vector<Corner> centre_line;
    std::size_t stray_cones;
    TrackStyle style{};
};

/// All layouts: the three topologies of the RLD paper (straight, circle, curvy), then closed circuits within
/// the limits of the Formula Student rules, of 200 to 500 m.
[[nodiscard]] std::span<const TrackLayout> track_layouts();

}  // namespace conelane
