#pragma once

#include "experiments/scenes/annotated_scene.hpp"
#include "experiments/tracks/track_boundaries.hpp"

#include <filesystem>
#include <span>

namespace conelane::experiments {

/// Writes a scenes file and its companion beside it: both whole, or both stay as they were. Throws like
/// write_scenes.
void write_scene_pair(const std::filesystem::path& file, std::span<const AnnotatedScene> scenes,
                      const TrackBoundariesByName& tracks);

}  // namespace conelane::experiments
