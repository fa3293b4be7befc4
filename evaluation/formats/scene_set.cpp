#include "evaluation/formats/scene_set.hpp"

#include "evaluation/formats/scene_options_fields.hpp"
#include "evaluation/formats/track_spec.hpp"
#include "evaluation/input_error.hpp"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace conelane {

SceneSet make_scene_set(const std::vector<std::string>& track_specs, const SceneOptions& options,
                        const Shard& shard) {
    LeftOutScenes left_out;
    SceneSet set = make_scene_set(track_specs, options, shard, left_out);
    if (!left_out.empty()) fmt::print(stderr, "conelane: {}\n", note_on(left_out));
    return set;
}

SceneSet make_scene_set(const std::vector<std::string>& track_specs, const SceneOptions& options,
                        const Shard& shard, LeftOutScenes& left_out, const LapsMade& made) {
    validate(options);
    left_out.clear();
    SceneSet set;
    std::size_t laps_with_scenes = 0;
    std::vector<Track> tracks;
    for (const std::string& spec : track_specs)
        std::ranges::move(load_tracks_aloud(spec), std::back_inserter(tracks));
    std::size_t done = 0;  // laps
    for (const Track& track : tracks) {
        const auto [entry, is_new] = set.tracks.emplace(track.name, boundaries(track));
        if (!is_new) throw InputError("", 0, "--tracks", "track '" + track.name + "' is named twice");
        const TrackLaps laps(track, options);
        std::vector<std::string> of_track;  // ids of the scenes left out
        for (std::size_t lap = 0; lap < laps.size(); ++lap) {
            if (made) made(done++, tracks.size() * laps.size());
            // Laps without a scene are not counted, because no reader of a scenes file can know of them.
            if (laps_with_scenes % shard.count != shard.index) {
                if (!laps.is_empty(lap)) ++laps_with_scenes;
                continue;
            }
            const std::size_t scenes_before = set.scenes.size();
            for (AnnotatedScene& scene : laps.make(lap)) {
                if (scene.ground_truth || !track.driven.empty()) {
                    set.scenes.push_back(std::move(scene));
                } else {
                    of_track.push_back(scene.scene.id);
                }
            }
            if (set.scenes.size() > scenes_before) ++laps_with_scenes;
        }
        if (!of_track.empty()) merge(left_out, {{track.name, of_track}});
    }
    if (laps_with_scenes == 0) {
        throw InputError("", 0, "--tracks",
                         left_out.empty() ? "no pose sees two cones of both boundaries"
                                          : "the ground truth of every scene is degenerate: are left and "
                                            "right the wrong way round?");
    }
    return set;
}

bool same_lap(const AnnotatedScene& a, const AnnotatedScene& b) {
    return a.track == b.track && a.condition == b.condition &&
           a.false_positive_rate == b.false_positive_rate && a.range_m == b.range_m;
}

std::vector<std::size_t> lap_starts(std::span<const AnnotatedScene> scenes) {
    std::vector<std::size_t> starts;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        if (i == 0 || !same_lap(scenes[i - 1], scenes[i])) starts.push_back(i);
    }
    starts.push_back(scenes.size());
    return starts;
}

void write_scene_set(const std::filesystem::path& scenes_file, const SceneSet& set,
                     const LeftOutScenes& left_out) {
    write_scene_pair(scenes_file, set.scenes, set.tracks, left_out);
}

void merge(LeftOutScenes& left_out, const LeftOutScenes& of_shard) {
    for (const auto& [track, ids] : of_shard) {
        std::vector<std::string>& all = left_out[track];
        std::ranges::copy(ids, std::back_inserter(all));
        std::ranges::sort(all);
    }
}

std::string note_on(const LeftOutScenes& left_out) {
    std::size_t count = 0;
    std::string first;
    for (const auto& [track, ids] : left_out) {
        if (count == 0 && !ids.empty()) first = ids.front();
        count += ids.size();
    }
    if (count == 0) return "";
    return fmt::format("{} left out: the ground truth is degenerate; the first is {}",
                       count == 1 ? "1 scene is" : fmt::format("{} scenes are", count), first);
}

std::string table_note_on(const LeftOutScenes& left_out) {
    const std::string note = note_on(left_out);
    return note.empty() ? "" : "    " + note + "\n";
}

SceneOptions as_recorded(SceneOptions options) {
    if (!options.conditions.empty()) options.conditions = condition_names(options);
    return options;
}

nlohmann::ordered_json scene_options_json(const SceneOptions& options) {
    return value_json(as_recorded(options), "scenes");
}

}  // namespace conelane
