#pragma once

#include "evaluation/scenes/scene_set.hpp"
#include "evaluation/tracks/track_boundaries.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

/// Scenes that were not made since their ground truth is degenerate (see is_degenerate), for who says how
/// many there are. The companion of a scenes file holds them, in `left_out` of their track.
namespace conelane {

/// Ids in their order, by track.
using LeftOutScenes = std::map<std::string, std::vector<std::string>>;

/// Is told, while scenes are made, how many laps of how many are done.
using LapsMade = std::function<void(std::size_t done, std::size_t total)>;

/// The same as make_scene_set, and what was left out of it, which is then for the caller to say.
[[nodiscard]] SceneSet make_scene_set(const std::vector<std::string>& track_specs,
                                      const SceneOptions& options, const Shard& shard,
                                      LeftOutScenes& left_out, const LapsMade& made = {});

/// The same as write_scene_set, with what was left out in the companion.
void write_scene_set(const std::filesystem::path& scenes_file, const SceneSet& set,
                     const LeftOutScenes& left_out);

/// The same as write_track_boundaries, with what was left out. Its tracks must be among the others.
void write_track_boundaries(const std::filesystem::path& file, const TrackBoundariesByName& tracks,
                            const LeftOutScenes& left_out);

/// What a companion says; nothing where it says nothing. Throws InputError like read_track_boundaries.
[[nodiscard]] LeftOutScenes read_left_out(const std::filesystem::path& companion);

/// Adds those of another shard of the same run.
void merge(LeftOutScenes& left_out, const LeftOutScenes& of_shard);

/// How many and the first of them, without newline; empty where there are none.
[[nodiscard]] std::string note_on(const LeftOutScenes& left_out);
/// The same as a line below a table.
[[nodiscard]] std::string table_note_on(const LeftOutScenes& left_out);

}  // namespace conelane
