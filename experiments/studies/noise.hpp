#pragma once

#include "conelane/scene.hpp"

#include <cstddef>
#include <cstdint>

namespace conelane::experiments {

/// The number `index` of the scenes of a range: cones that are uniform in the closed half disc ahead of the
/// car at the origin. Depends on its arguments alone.
[[nodiscard]] Scene noise_scene(std::size_t cones, double range_m, std::size_t index, std::uint64_t seed);

}  // namespace conelane::experiments
