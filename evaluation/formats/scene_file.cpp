#include "evaluation/formats/scene_file.hpp"

#include "evaluation/formats/cone_json.hpp"

#include <unordered_set>

namespace conelane {
namespace {

using nlohmann::ordered_json;

std::unordered_set<ConeId> ids_of(const Scene& scene) {
    std::unordered_set<ConeId> ids;
    for (const Cone& cone : scene.cones) ids.insert(cone.id);
    return ids;
}

/// The runs of the ground truth name cones of the scene, each once.
struct GroundTruth {
    static void read(const JsonNode& json, AnnotatedScene& annotated) {
        const auto lane = json.find("ground_truth");
        if (!lane) return;
        const std::unordered_set<ConeId> ids = ids_of(annotated.scene);
        std::unordered_set<ConeId> unclaimed = ids;
        const auto read_run = [&](const char* key, std::vector<ConeId>& run) {
            const JsonNode list = lane->member(key);
            read_value(list, run);
            for (std::size_t i = 0; i < run.size(); ++i) {
                if (unclaimed.erase(run[i]) > 0) continue;
                list.element(i).fail(ids.contains(run[i])
                                         ? "cone id " + std::to_string(run[i]) + " is there twice"
                                         : "no cone has id " + std::to_string(run[i]));
            }
        };
        Lane& truth = annotated.ground_truth.emplace();
        read_run("left", truth.left);
        read_run("right", truth.right);
        if (const auto closed = lane->find("closed")) truth.closed = closed->boolean();
    }
    static void put(ordered_json& json, const AnnotatedScene& annotated, const std::string& /*place*/) {
        if (const auto& lane = annotated.ground_truth)
            json["ground_truth"] = {{"left", lane->left}, {"right", lane->right}, {"closed", lane->closed}};
    }
};

/// Only ids and places of missed cones are written.
struct Missed {
    static void read(const JsonNode& json, AnnotatedScene& annotated) {
        const auto missed = json.find("missed");
        if (!missed) return;
        read_value(*missed, annotated.missed);
        std::unordered_set<ConeId> ids = ids_of(annotated.scene);
        for (std::size_t i = 0; i < annotated.missed.size(); ++i) {
            const ConeId id = annotated.missed[i].id;
            if (!ids.insert(id).second)
                missed->element(i).fail("cone id " + std::to_string(id) + " is there twice");
        }
    }
    static void put(ordered_json& json, const AnnotatedScene& annotated, const std::string& place) {
        for (const Cone& cone : annotated.missed) {
            ordered_json& missed = json["missed"].emplace_back();
            put_fields(missed, cone, std::tuple_cat(kConeId, kConePlace), place + "missed.");
        }
    }
};

/// All but the id, which is a scene's line if it has none.
struct Sighting {
    static void read(const JsonNode& json, AnnotatedScene& annotated) {
        Scene& scene = annotated.scene;
        read_value(json.member("pose"), scene.pose);
        const JsonNode cones = json.member("cones");
        read_value(cones, scene.cones);
        if (scene.cones.empty()) cones.fail("must hold at least one cone");
        json.require_valid([&] { validate(scene); });
    }
    static void put(ordered_json& json, const AnnotatedScene& annotated, const std::string& place) {
        json["pose"] = value_json(annotated.scene.pose, place + "pose");
        json["cones"] = value_json(annotated.scene.cones, place + "cones");
    }
};

}  // namespace

template <>
inline constexpr std::tuple kFields<AnnotatedScene>{
    Field{"id", kInside<&AnnotatedScene::scene, &Scene::id>, Absent::when_read},
    Sighting{},
    GroundTruth{},
    Field{"track", &AnnotatedScene::track, Absent::if_empty},
    Field{"false_positive_rate", &AnnotatedScene::false_positive_rate, Range::share},
    Field{"range", &AnnotatedScene::range_m, Range::not_negative},
    Field{"seed", &AnnotatedScene::seed},
    Field{"condition", &AnnotatedScene::condition, Absent::if_empty},
    Field{"travelled", &AnnotatedScene::travelled_m, Range::not_negative},
    Missed{}};

template <>
inline constexpr std::tuple kFields<TrackBoundaries>{
    Field{"left", &TrackBoundaries::left}, Field{"right", &TrackBoundaries::right},
    Field{"closed", &TrackBoundaries::closed}, Field{"driven", &TrackBoundaries::driven, Absent::if_empty}};

namespace {

AnnotatedScene read_scene(const JsonNode& json) {
    AnnotatedScene annotated;
    annotated.scene.id = std::to_string(json.line());
    read_fields(json, annotated, kFields<AnnotatedScene>);
    return annotated;
}

void put_scenes(std::ostream& stream, std::span<const AnnotatedScene> scenes) {
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const std::string place = "scenes[" + std::to_string(i) + "]";
        try {
            validate(scenes[i].scene);
        } catch (const InvalidInput& error) {
            throw InvalidInput(place + "." + error.key(), reason_of(error));
        }
        stream << to_line(value_json(scenes[i], place)) << '\n';
    }
}

void put_track_boundaries(std::ostream& stream, const TrackBoundariesByName& tracks,
                          const LeftOutScenes& left_out) {
    ordered_json json = ordered_json::object();
    for (const auto& [name, boundaries] : tracks) {
        json[name] = value_json(boundaries, name);
        if (const auto ids = left_out.find(name); ids != left_out.end()) json[name]["left_out"] = ids->second;
    }
    stream << to_line(json) << '\n';
}

}  // namespace

std::vector<AnnotatedScene> read_scenes(const std::filesystem::path& file) {
    std::vector<AnnotatedScene> scenes;
    FirstLines<std::string> ids;
    for_each_json_line(file, [&](const JsonNode& json) {
        const std::string& id = scenes.emplace_back(read_scene(json)).scene.id;
        ids.require_new(id, json, "id", "scene id \"" + id + "\" is there twice");
    });
    if (scenes.empty()) throw InputError(file, 0, "", "holds no scene");
    return scenes;
}

void for_each_scene_line(std::istream& stream, const std::function<void(const SceneLine&)>& use) {
    const auto read = [](const JsonNode& json, SceneLine& line) {
        const auto reset = json.find("reset");
        line.reset = reset && reset->boolean();
        if (!line.reset) line.scene = read_scene(json);
    };
    for_each_stream_line<SceneLine>(stream, read, use);
}

std::string scene_line(const Scene& scene) {
    AnnotatedScene bare;
    bare.scene = scene;
    return to_line(value_json(bare, "scene"));
}

void write_scenes(const std::filesystem::path& file, std::span<const AnnotatedScene> scenes) {
    AtomicFile output(file);
    put_scenes(output.stream(), scenes);
    output.commit();
}

void write_scene_pair(const std::filesystem::path& file, std::span<const AnnotatedScene> scenes,
                      const TrackBoundariesByName& tracks, const LeftOutScenes& left_out) {
    AtomicFile companion(track_boundaries_path(file));
    put_track_boundaries(companion.stream(), tracks, left_out);
    AtomicFile output(file);
    put_scenes(output.stream(), scenes);
    commit_together(std::array{&companion, &output});
}

std::filesystem::path track_boundaries_path(const std::filesystem::path& scenes) {
    constexpr std::string_view kEnding = ".scenes.jsonl";
    std::string name = scenes.filename().string();
    name = name.ends_with(kEnding) ? name.substr(0, name.size() - kEnding.size()) : scenes.stem().string();
    return scenes.parent_path() / (name + ".tracks.json");
}

TrackBoundariesByName read_track_boundaries(const std::filesystem::path& file) {
    TrackBoundariesByName tracks;
    with_json_file(file, [&](const JsonNode& json) {
        for (const std::string& name : json.keys()) {
            const JsonNode track = json.member(name);
            TrackBoundaries& boundaries = tracks[name];
            read_value(track, boundaries);
            const bool has_driven = track.find("driven").has_value();
            for (const auto& [key, line] : {std::pair{"driven", &boundaries.driven},
                                            {"left", &boundaries.left},
                                            {"right", &boundaries.right}}) {
                if (line->empty() && has_driven == (line == &boundaries.driven))
                    track.fail_in(key, "must hold at least one point");
            }
        }
    });
    return tracks;
}

void write_track_boundaries(const std::filesystem::path& file, const TrackBoundariesByName& tracks) {
    AtomicFile output(file);
    put_track_boundaries(output.stream(), tracks, {});
    output.commit();
}

LeftOutScenes read_left_out(const std::filesystem::path& companion) {
    LeftOutScenes left_out;
    with_json_file(companion, [&](const JsonNode& json) {
        for (const std::string& name : json.keys()) {
            if (const auto ids = json.member(name).find("left_out")) read_value(*ids, left_out[name]);
        }
    });
    return left_out;
}

}  // namespace conelane
