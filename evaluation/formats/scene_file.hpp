#pragma once

#include "evaluation/formats/json_records.hpp"
#include "evaluation/world/annotated_scene.hpp"
#include "evaluation/world/track.hpp"

namespace conelane {

/// `color` and `color_probabilities` ([unknown, blue, yellow, orange, big orange]) of a cone, each of which
/// may be absent. Where only the probabilities are there, the label is the most probable one.
struct ConeColors {
    static void read(const JsonNode& json, Cone& cone);
    static void put(nlohmann::ordered_json& json, const Cone& cone, const std::string& place);
};

/// How uncertain a cone is: writes `color_probabilities`, reads and writes `position_covariance`, a symmetric
/// positive semidefinite matrix of two rows. Each may be absent.
struct ConeUncertainty {
    static void read(const JsonNode& json, Cone& cone);
    static void put(nlohmann::ordered_json& json, const Cone& cone, const std::string& place);
};

struct ConeX {
    decltype(auto) operator()(auto& placed) const { return placed.position.x(); }
};
struct ConeY {
    decltype(auto) operator()(auto& placed) const { return placed.position.y(); }
};
inline constexpr std::tuple kConePlace{Field{"x", ConeX{}}, Field{"y", ConeY{}}};

/// All but the id.
inline constexpr std::tuple kSeenCone = std::tuple_cat(
    kConePlace,
    std::tuple{ConeColors{}, Field{"confidence", &Cone::confidence, Absent::when_read}, ConeUncertainty{}});
inline constexpr std::tuple kConeId{Field{"id", &Cone::id}};

template <>
inline constexpr std::tuple kFields<Cone> = std::tuple_cat(kConeId, kSeenCone);
template <>
inline constexpr std::tuple kFields<Pose> = std::tuple_cat(kConePlace,
                                                           std::tuple{Field{"yaw", &Pose::yaw_rad}});

/// Scenes of a `*.scenes.jsonl` file, in its order. A scene without an id gets its line number, from 1.
/// Throws InputError naming file, line and key: for invalid JSON, a scene without cones, a cone id, scene id
/// or ground-truth id that occurs twice, a ground-truth id without a cone, or a file without scenes.
[[nodiscard]] std::vector<AnnotatedScene> read_scenes(const std::filesystem::path& file);

/// A line of a stream of scenes.
struct SceneLine {
    std::size_t number = 0;               ///< from 1, blank lines counted
    std::optional<AnnotatedScene> scene;  ///< absent if the line is not a scene
    bool reset = false;                   ///< {"reset": true}: another lap begins
    std::string fault;                    ///< what is wrong with any other line
};

/// Calls `use` with each line of a stream that is not blank, before the next one is read. An invalid line is
/// passed on with its fault; scenes may have equal ids.
void for_each_scene_line(std::istream& stream, const std::function<void(const SceneLine&)>& use);

/// A scene as its line, without newline, with only what a detector may know. Precondition: the scene is
/// valid.
[[nodiscard]] std::string scene_line(const Scene& scene);

/// Throws InvalidInput if a number is not finite, InputError if the file cannot be written; an old file then
/// stays unchanged.
void write_scenes(const std::filesystem::path& file, std::span<const AnnotatedScene> scenes);

/// The companion of a scenes file: NAME.tracks.json beside NAME.scenes.jsonl. For other names, the last
/// extension is replaced.
[[nodiscard]] std::filesystem::path track_boundaries_path(const std::filesystem::path& scenes);

/// Throws InputError naming file and key, or the line that is not JSON. Each boundary has at least one point,
/// except in a track with a driven path.
[[nodiscard]] TrackBoundariesByName read_track_boundaries(const std::filesystem::path& file);

/// Throws like write_scenes.
void write_track_boundaries(const std::filesystem::path& file, const TrackBoundariesByName& tracks);

/// Ids, in their order, of the scenes that were left out because their ground truth is degenerate (see
/// is_degenerate), by track. The companion holds them in `left_out` of their track.
using LeftOutScenes = std::map<std::string, std::vector<std::string>>;

/// Writes a scenes file and its companion beside it: both completely, or both stay unchanged. The tracks of
/// the scenes left out must be among the others. Throws like write_scenes.
void write_scene_pair(const std::filesystem::path& file, std::span<const AnnotatedScene> scenes,
                      const TrackBoundariesByName& tracks, const LeftOutScenes& left_out);

/// The scenes left out according to a companion; nothing if it has no such key. Throws InputError like
/// read_track_boundaries.
[[nodiscard]] LeftOutScenes read_left_out(const std::filesystem::path& companion);

}  // namespace conelane
