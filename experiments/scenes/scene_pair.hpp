#pragma once

#include "experiments/scenes/annotated_scene.hpp"
#include "experiments/scenes/left_out_scenes.hpp"
#include "experiments/tracks/track_boundaries.hpp"

#include <filesystem>
#include <span>

namespace conelane::experiments {

/// Writes a scenes file and its companion beside it, with what was left out of the scenes: both whole, or
/// both stay as they were. Throws like write_scenes.
void write_scene_pair(const std::filesystem::path& file, std::span<const AnnotatedScene> scenes,
                      const TrackBoundariesByName& tracks, const LeftOutScenes& left_out);

}  // namespace conelane::experiments
