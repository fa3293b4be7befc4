#pragma once

#include "evaluation/tracks/track.hpp"

#include <cstddef>
#include <cstdint>

namespace conelane::experiments {

/// Another track of the same kind, to learn the lanes and not the track: stretched along an axis and across
/// it, the axis and both factors drawn at random, up to exp(0.15) = 1.16 either way; every second one is
/// driven the other way round. `number`: which one, from 1; it is part of the name and of what the draws
/// depend on, with the name and the seed.
[[nodiscard]] Track track_variant(Track track, std::size_t number, std::uint64_t seed);

}  // namespace conelane::experiments
