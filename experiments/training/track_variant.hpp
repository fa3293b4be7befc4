#pragma once

#include "evaluation/world/track.hpp"

#include <cstddef>
#include <cstdint>

namespace conelane::experiments {

/// A variant of a track, so that lanes are learned instead of tracks: stretched along an axis and across it,
/// with a random axis and random factors up to exp(0.15) = 1.16 either way; every second variant is driven in
/// the other direction. `number`, from 1, is part of the name and, with the name and the seed, determines the
/// draws.
[[nodiscard]] Track track_variant(Track track, std::size_t number, std::uint64_t seed);

}  // namespace conelane::experiments
