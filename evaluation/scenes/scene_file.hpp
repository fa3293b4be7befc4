#pragma once

#include "evaluation/scenes/annotated_scene.hpp"
#include "evaluation/tracks/track_boundaries.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <istream>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace conelane {

/// Scenes of a `*.scenes.jsonl` file, in its order. A scene without an id gets its line number, from 1.
/// Throws InputError naming file, line and key: beside what is no such JSON, where a scene has no cone, a
/// cone id, a scene id or a ground-truth id is there twice, a ground-truth id has no cone, or the file has no
/// scene.
[[nodiscard]] std::vector<AnnotatedScene> read_scenes(const std::filesystem::path& file);

/// A line of a stream of scenes.
struct SceneLine {
    std::size_t number = 0;               ///< from 1, blank lines counted
    std::optional<AnnotatedScene> scene;  ///< absent where the line is no scene
    bool reset = false;                   ///< {"reset": true}: what follows is another lap
    std::string fault;                    ///< what is wrong with a line that is neither
};

/// Calls `use` with each line of a stream that is not blank, before the next one is read. A line that is
/// wrong is passed on as such; its scenes may have the same id as others.
void for_each_scene_line(std::istream& stream, const std::function<void(const SceneLine&)>& use);

/// A scene as its line, without newline and with nothing but what a detector may know. Precondition: the
/// scene is valid.
[[nodiscard]] std::string scene_line(const Scene& scene);

/// Throws InvalidInput where a number is not finite, InputError where the file cannot be written; then an old
/// file stays as it was.
void write_scenes(const std::filesystem::path& file, std::span<const AnnotatedScene> scenes);

/// The companion of a scenes file: NAME.tracks.json beside NAME.scenes.jsonl. Where the name ends otherwise,
/// its last extension is replaced.
[[nodiscard]] std::filesystem::path track_boundaries_path(const std::filesystem::path& scenes);

/// Throws InputError naming file and key, and the line of what is no JSON. Each boundary has a point at
/// least, but for those of a track with a driven path.
[[nodiscard]] TrackBoundariesByName read_track_boundaries(const std::filesystem::path& file);

/// Throws like write_scenes.
void write_track_boundaries(const std::filesystem::path& file, const TrackBoundariesByName& tracks);

}  // namespace conelane
