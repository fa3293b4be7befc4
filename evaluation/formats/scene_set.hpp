#pragma once

#include "evaluation/formats/scene_file.hpp"
#include "evaluation/world/scene_generation.hpp"

#include <nlohmann/json_fwd.hpp>

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

/// Called while scenes are made, with the number of laps that are done and their total.
using LapsMade = std::function<void(std::size_t done, std::size_t total)>;

/// Every pose on the centre line of every track that the SPECs of load_tracks name, under every rate and
/// range; of these the laps of the shard, possibly none. Takes memory, and nearly all time, only for these
/// laps. The caller has to report the scenes left out. Throws InputError if a track is named twice or no
/// scene of any shard has a ground truth.
[[nodiscard]] SceneSet make_scene_set(const std::vector<std::string>& track_specs,
                                      const SceneOptions& options, const Shard& shard,
                                      LeftOutScenes& left_out, const LapsMade& made = {});
/// The same; it prints the number of scenes left out on standard error.
[[nodiscard]] SceneSet make_scene_set(const std::vector<std::string>& track_specs,
                                      const SceneOptions& options, const Shard& shard = {});

/// Whether two scenes are of one lap: the same track, condition, rate and range.
[[nodiscard]] bool same_lap(const AnnotatedScene& a, const AnnotatedScene& b);

/// First scene of each lap, and the number of scenes at the end. A lap is a run of scenes of one track,
/// condition, rate and range. It is the unit of work, because a detector with state must see each lap alone
/// and from its beginning.
[[nodiscard]] std::vector<std::size_t> lap_starts(std::span<const AnnotatedScene> scenes);

/// Writes the scenes file and its companion beside it.
void write_scene_set(const std::filesystem::path& scenes_file, const SceneSet& set,
                     const LeftOutScenes& left_out = {});

/// Adds those of another shard of the same run.
void merge(LeftOutScenes& left_out, const LeftOutScenes& of_shard);

/// Their number and the first of them, without newline; empty if there are none.
[[nodiscard]] std::string note_on(const LeftOutScenes& left_out);
/// The same as a line below a table.
[[nodiscard]] std::string table_note_on(const LeftOutScenes& left_out);

/// The options that scenes depend on beside their tracks, for the record of a run, a training or a tuning;
/// keys as on the command line. `condition`, `persist` and `nearest` are present only if they were given.
[[nodiscard]] nlohmann::ordered_json scene_options_json(const SceneOptions& options);

/// The options as records have them: their conditions by the names that the other options change.
[[nodiscard]] SceneOptions as_recorded(SceneOptions options);

}  // namespace conelane
