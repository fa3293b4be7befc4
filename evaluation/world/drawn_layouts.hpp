#pragma once

#include "evaluation/world/track_layouts.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace conelane {

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
