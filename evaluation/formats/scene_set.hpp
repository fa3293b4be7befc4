#pragma once

#include "evaluation/world/annotated_scene.hpp"
#include "evaluation/world/scene_generation.hpp"
#include "evaluation/world/track_boundaries.hpp"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace conelane {

/// The scenes of several tracks, and the boundaries that divergence is measured against.
struct SceneSet {
    std::vector<AnnotatedScene> scenes;
    TrackBoundariesByName tracks;
};

/// Part `index` of `count`, from 0: every count-th lap that has a scene.
struct Shard {
    std::size_t index = 0;
    std::size_t count = 1;
};

/// Every pose on the centre line of every track that the SPECs of load_tracks name, under every rate and
/// range; of these the laps of the shard, possibly none. Takes memory, and nearly all time, only for these
/// laps. Throws InputError if a track is named twice or no scene of any shard has a ground truth.
[[nodiscard]] SceneSet make_scene_set(const std::vector<std::string>& track_specs,
                                      const SceneOptions& options, const Shard& shard = {});

/// Whether two scenes are of one lap: the same track, condition, rate and range.
[[nodiscard]] bool same_lap(const AnnotatedScene& a, const AnnotatedScene& b);

/// First scene of each lap, and the number of scenes at the end. A lap is a run of scenes of one track,
/// condition, rate and range. It is the unit of work, because a detector with state must see each lap alone
/// and from its beginning.
[[nodiscard]] std::vector<std::size_t> lap_starts(std::span<const AnnotatedScene> scenes);

/// Writes the scenes file and its companion beside it.
void write_scene_set(const std::filesystem::path& scenes_file, const SceneSet& set);

}  // namespace conelane
