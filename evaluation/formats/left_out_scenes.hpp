#pragma once

#include "evaluation/formats/scene_set.hpp"
#include "evaluation/world/track_boundaries.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

/// Scenes that were left out because their ground truth is degenerate (see is_degenerate), for reports of
/// their number. The companion of a scenes file holds them, in `left_out` of their track.
namespace conelane {

/// Ids in their order, by track.
using LeftOutScenes = std::map<std::string, std::vector<std::string>>;

/// Called while scenes are made, with the number of laps that are done and their total.
using LapsMade = std::function<void(std::size_t done, std::size_t total)>;

/// The same as make_scene_set, and the scenes left out, which the caller has to report.
[[nodiscard]] SceneSet make_scene_set(const std::vector<std::string>& track_specs,
                                      const SceneOptions& options, const Shard& shard,
                                      LeftOutScenes& left_out, const LapsMade& made = {});

/// The same as write_scene_set, with the scenes left out in the companion.
void write_scene_set(const std::filesystem::path& scenes_file, const SceneSet& set,
                     const LeftOutScenes& left_out);

/// The same as write_track_boundaries, with the scenes left out. Their tracks must be among the others.
void write_track_boundaries(const std::filesystem::path& file, const TrackBoundariesByName& tracks,
                            const LeftOutScenes& left_out);

/// The scenes left out according to a companion; nothing if it has no such key. Throws InputError like
/// read_track_boundaries.
[[nodiscard]] LeftOutScenes read_left_out(const std::filesystem::path& companion);

/// Adds those of another shard of the same run.
void merge(LeftOutScenes& left_out, const LeftOutScenes& of_shard);

/// Their number and the first of them, without newline; empty if there are none.
[[nodiscard]] std::string note_on(const LeftOutScenes& left_out);
/// The same as a line below a table.
[[nodiscard]] std::string table_note_on(const LeftOutScenes& left_out);

}  // namespace conelane
