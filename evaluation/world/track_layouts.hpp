#pragma once

#include "evaluation/world/rounded_path.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
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

/// Names of the layouts that each seed draws, with properties of recorded courses that the fixed layouts do
/// not have:
/// - `legs`: four parallel legs or six, their boundaries 3 to 6 m apart;
/// - `tight_hairpins`: the same with a lane of 2.8 to 3.2 m, cones every 1.5 to 2 m, radii of about 3 m;
/// - `gates`: a loop with two gates of big orange cones, each in a gap of the boundaries of 10 to 12 m;
/// - `wide`: a loop of 4.8 to 6 m with cones up to 6 m apart.
[[nodiscard]] std::span<const std::string_view> drawn_layout_names();

/// Precondition: the name is one of drawn_layout_names.
[[nodiscard]] TrackLayout draw_layout(std::string_view name, std::uint64_t seed);

}  // namespace conelane
