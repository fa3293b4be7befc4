#pragma once

#include "evaluation/formats/left_out_scenes.hpp"
#include "evaluation/world/annotated_scene.hpp"
#include "evaluation/world/track_boundaries.hpp"

#include <filesystem>
#include <span>

namespace conelane {

/// Writes a scenes file and its companion beside it, with the scenes left out: both completely, or both stay
/// unchanged. Throws like write_scenes.
void write_scene_pair(const std::filesystem::path& file, std::span<const AnnotatedScene> scenes,
                      const TrackBoundariesByName& tracks, const LeftOutScenes& left_out);

}  // namespace conelane
