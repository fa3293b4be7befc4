#include "experiments/scenes/scene_set.hpp"

#include "experiments/files/input_error.hpp"
#include "experiments/files/scene_file.hpp"
#include "experiments/tracks/centre_line.hpp"
#include "experiments/tracks/track_spec.hpp"

#include <algorithm>
#include <iterator>

namespace conelane::experiments {

SceneSet make_scene_set(const std::vector<std::string>& track_specs, const SceneOptions& options) {
    validate(options);
    SceneSet set;
    for (const std::string& spec : track_specs) {
        for (const Track& track : load_tracks(spec)) {
            const auto [entry, is_new] = set.tracks.emplace(track.name, boundaries(track));
            if (!is_new) throw InputError("", 0, "--tracks", "track '" + track.name + "' is named twice");
            const std::vector<Pose> poses = centre_line_poses(entry->second, options.every_m);
            std::ranges::move(generate_scenes(track, poses, options), std::back_inserter(set.scenes));
        }
    }
    if (set.scenes.empty()) throw InputError("", 0, "--tracks", "no pose sees two cones of both boundaries");
    return set;
}

void write_scene_set(const std::filesystem::path& scenes_file, const SceneSet& set) {
    write_track_boundaries(track_boundaries_path(scenes_file), set.tracks);
    write_scenes(scenes_file, set.scenes);
}

}  // namespace conelane::experiments
