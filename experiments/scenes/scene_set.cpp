#include "experiments/scenes/scene_set.hpp"

#include "experiments/files/input_error.hpp"
#include "experiments/scenes/scene_file.hpp"
#include "experiments/scenes/scene_pair.hpp"
#include "experiments/tracks/track_spec.hpp"

#include <algorithm>
#include <cstdio>
#include <iterator>

#include <fmt/core.h>

namespace conelane::experiments {

SceneSet make_scene_set(const std::vector<std::string>& track_specs, const SceneOptions& options,
                        const Shard& shard) {
    validate(options);
    SceneSet set;
    std::size_t laps_with_scenes = 0;
    for (const std::string& spec : track_specs) {
        for (const Track& track : load_tracks(spec)) {
            const auto [entry, is_new] = set.tracks.emplace(track.name, boundaries(track));
            if (!is_new) throw InputError("", 0, "--tracks", "track '" + track.name + "' is named twice");
            for (const std::string& warning : track.warnings) {
                fmt::print(stderr, "conelane: {}: {}\n", track.name, warning);
            }
            const TrackLaps laps(track, options);
            for (std::size_t lap = 0; lap < laps.size(); ++lap) {
                // Laps without a scene are not counted: no reader of a scenes file can know of them.
                if (laps_with_scenes % shard.count != shard.index) {
                    if (!laps.is_empty(lap)) ++laps_with_scenes;
                    continue;
                }
                std::vector<AnnotatedScene> scenes = laps.make(lap);
                if (!scenes.empty()) ++laps_with_scenes;
                std::ranges::move(scenes, std::back_inserter(set.scenes));
            }
        }
    }
    if (laps_with_scenes == 0)
        throw InputError("", 0, "--tracks", "no pose sees two cones of both boundaries");
    return set;
}

void write_scene_set(const std::filesystem::path& scenes_file, const SceneSet& set) {
    write_scene_pair(scenes_file, set.scenes, set.tracks);
}

}  // namespace conelane::experiments
