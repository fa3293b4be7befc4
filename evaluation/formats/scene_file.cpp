#include "evaluation/formats/scene_file.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/cone_json.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/left_out_scenes.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/formats/scene_pair.hpp"

#include <array>
#include <ostream>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace conelane {
namespace {

using nlohmann::ordered_json;

Cone read_cone(const JsonNode& json) {
    Cone cone;
    cone.id = json.member("id").integer();
    cone.position = {json.member("x").number(), json.member("y").number()};
    read_color(json, cone);
    read_covariance(json, cone);
    if (const auto confidence = json.find("confidence")) cone.confidence = confidence->number();
    return cone;
}

/// `unclaimed`: ids of the cones that are in no run so far.
std::vector<ConeId> read_run(const JsonNode& json, const std::unordered_set<ConeId>& cone_ids,
                             std::unordered_set<ConeId>& unclaimed) {
    std::vector<ConeId> run;
    const std::size_t size = json.array_size();
    for (std::size_t i = 0; i < size; ++i) {
        const JsonNode element = json.element(i);
        const ConeId id = element.integer();
        if (unclaimed.erase(id) == 0) {
            element.fail(cone_ids.contains(id) ? "cone id " + std::to_string(id) + " is there twice"
                                               : "no cone has id " + std::to_string(id));
        }
        run.push_back(id);
    }
    return run;
}

Lane read_ground_truth(const JsonNode& json, const Scene& scene) {
    std::unordered_set<ConeId> cone_ids;
    for (const Cone& cone : scene.cones) cone_ids.insert(cone.id);
    std::unordered_set<ConeId> unclaimed = cone_ids;
    Lane lane;
    lane.left = read_run(json.member("left"), cone_ids, unclaimed);
    lane.right = read_run(json.member("right"), cone_ids, unclaimed);
    if (const auto closed = json.find("closed")) lane.closed = closed->boolean();
    return lane;
}

std::vector<Cone> read_missed(const JsonNode& json, const Scene& scene) {
    std::unordered_set<ConeId> ids;
    for (const Cone& cone : scene.cones) ids.insert(cone.id);
    std::vector<Cone> missed;
    const std::size_t size = json.array_size();
    for (std::size_t i = 0; i < size; ++i) {
        missed.push_back(read_cone(json.element(i)));
        if (!ids.insert(missed.back().id).second) {
            json.element(i).fail("cone id " + std::to_string(missed.back().id) + " is there twice");
        }
    }
    return missed;
}

AnnotatedScene read_scene(const JsonNode& json) {
    AnnotatedScene result;
    Scene& scene = result.scene;
    const auto id = json.find("id");
    scene.id = id ? id->string() : std::to_string(json.line());
    const JsonNode pose = json.member("pose");
    scene.pose.position = {pose.member("x").number(), pose.member("y").number()};
    scene.pose.yaw_rad = pose.member("yaw").number();
    const JsonNode cones = json.member("cones");
    const std::size_t size = cones.array_size();
    if (size == 0) cones.fail("must hold at least one cone");
    scene.cones.reserve(size);
    for (std::size_t i = 0; i < size; ++i) scene.cones.push_back(read_cone(cones.element(i)));
    json.require_valid([&] { validate(scene); });
    if (const auto lane = json.find("ground_truth")) result.ground_truth = read_ground_truth(*lane, scene);
    if (const auto track = json.find("track")) result.track = track->string();
    if (const auto rate = json.find("false_positive_rate")) {
        result.false_positive_rate = rate->number_in(0.0, 1.0);
    }
    if (const auto range = json.find("range")) result.range_m = range->non_negative_number();
    if (const auto seed = json.find("seed")) result.seed = seed->unsigned_integer();
    if (const auto condition = json.find("condition")) result.condition = condition->string();
    if (const auto travelled = json.find("travelled")) {
        result.travelled_m = travelled->non_negative_number();
    }
    if (const auto missed = json.find("missed")) result.missed = read_missed(*missed, scene);
    return result;
}

/// Precondition: the scene is valid. `key` names the scene in errors.
ordered_json to_json(const AnnotatedScene& annotated, const std::string& key) {
    const Scene& scene = annotated.scene;
    ordered_json cones = ordered_json::array();
    for (const Cone& cone : scene.cones) {
        cones.push_back({{"id", cone.id},
                         {"x", cone.position.x()},
                         {"y", cone.position.y()},
                         {"color", to_string(cone.color)},
                         {"confidence", cone.confidence}});
        if (cone.color_probabilities)
            cones.back()["color_probabilities"] = color_probabilities_json(*cone.color_probabilities);
        if (cone.position_covariance)
            cones.back()["position_covariance"] = covariance_json(*cone.position_covariance);
    }
    ordered_json json{
        {"id", scene.id},
        {"pose",
         {{"x", scene.pose.position.x()}, {"y", scene.pose.position.y()}, {"yaw", scene.pose.yaw_rad}}},
        {"cones", std::move(cones)}};
    if (const auto& lane = annotated.ground_truth) {
        json["ground_truth"] = {{"left", lane->left}, {"right", lane->right}, {"closed", lane->closed}};
    }
    if (!annotated.track.empty()) json["track"] = annotated.track;
    if (const auto& rate = annotated.false_positive_rate) {
        json["false_positive_rate"] = require_finite(*rate, key + ".false_positive_rate");
    }
    if (const auto& range_m = annotated.range_m) json["range"] = require_finite(*range_m, key + ".range");
    if (annotated.seed) json["seed"] = *annotated.seed;
    if (!annotated.condition.empty()) json["condition"] = annotated.condition;
    if (const auto& travelled_m = annotated.travelled_m) {
        json["travelled"] = require_finite(*travelled_m, key + ".travelled");
    }
    for (const Cone& cone : annotated.missed) {
        json["missed"].push_back({{"id", cone.id},
                                  {"x", require_finite(cone.position.x(), key + ".missed")},
                                  {"y", require_finite(cone.position.y(), key + ".missed")}});
    }
    return json;
}

std::vector<Point> read_polyline(const JsonNode& json, bool may_be_empty) {
    std::vector<Point> polyline;
    const std::size_t size = json.array_size();
    if (size == 0 && !may_be_empty) json.fail("must hold at least one point");
    polyline.reserve(size);
    for (std::size_t i = 0; i < size; ++i) {
        const JsonNode point = json.element(i);
        if (point.array_size() != 2) point.fail("must be [x, y]");
        polyline.emplace_back(point.element(0).number(), point.element(1).number());
    }
    return polyline;
}

ordered_json to_json(const std::vector<Point>& polyline, const std::string& key) {
    ordered_json json = ordered_json::array();
    for (const Point& point : polyline) {
        json.push_back(ordered_json::array({require_finite(point.x(), key), require_finite(point.y(), key)}));
    }
    return json;
}

}  // namespace

std::vector<AnnotatedScene> read_scenes(const std::filesystem::path& file) {
    std::vector<AnnotatedScene> scenes;
    std::unordered_map<std::string, std::size_t> line_of;
    for_each_json_line(file, [&](const JsonNode& json) {
        AnnotatedScene scene = read_scene(json);
        const auto [first, is_new] = line_of.emplace(scene.scene.id, json.line());
        if (!is_new) {
            throw InputError(file, json.line(), "id",
                             "scene id \"" + scene.scene.id + "\" is there twice, first on line " +
                                 std::to_string(first->second));
        }
        scenes.push_back(std::move(scene));
    });
    if (scenes.empty()) throw InputError(file, 0, "", "holds no scene");
    return scenes;
}

void for_each_scene_line(std::istream& stream, const std::function<void(const SceneLine&)>& use) {
    std::size_t number = 0;
    for (std::string text; std::getline(stream, text);) {
        ++number;
        if (is_blank(text)) continue;
        SceneLine line{number, {}, false, {}};
        try {
            with_json_line(text, "", number, [&](const JsonNode& json) {
                const auto reset = json.find("reset");
                line.reset = reset && reset->boolean();
                if (!line.reset) line.scene = read_scene(json);
            });
        } catch (const InputError& error) {
            line.fault = error.what();
        }
        use(line);
    }
}

std::string scene_line(const Scene& scene) {
    AnnotatedScene bare;
    bare.scene = scene;
    return to_line(to_json(bare, ""));
}

namespace {

void put_scenes(std::ostream& stream, std::span<const AnnotatedScene> scenes) {
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const std::string key = "scenes[" + std::to_string(i) + "]";
        try {
            validate(scenes[i].scene);
        } catch (const InvalidInput& error) {
            throw InvalidInput(key + "." + error.key(), reason_of(error));
        }
        stream << to_line(to_json(scenes[i], key)) << '\n';
    }
}

void put_track_boundaries(std::ostream& stream, const TrackBoundariesByName& tracks,
                          const LeftOutScenes& left_out) {
    ordered_json json = ordered_json::object();
    for (const auto& [name, boundaries] : tracks) {
        json[name] = {{"left", to_json(boundaries.left, name + ".left")},
                      {"right", to_json(boundaries.right, name + ".right")},
                      {"closed", boundaries.closed}};
        if (!boundaries.driven.empty()) json[name]["driven"] = to_json(boundaries.driven, name + ".driven");
        if (const auto ids = left_out.find(name); ids != left_out.end()) json[name]["left_out"] = ids->second;
    }
    stream << to_line(json) << '\n';
}

}  // namespace

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
            const auto driven = track.find("driven");
            if (driven) boundaries.driven = read_polyline(*driven, false);
            boundaries.left = read_polyline(track.member("left"), driven.has_value());
            boundaries.right = read_polyline(track.member("right"), driven.has_value());
            boundaries.closed = track.member("closed").boolean();
        }
    });
    return tracks;
}

void write_track_boundaries(const std::filesystem::path& file, const TrackBoundariesByName& tracks) {
    write_track_boundaries(file, tracks, {});
}

void write_track_boundaries(const std::filesystem::path& file, const TrackBoundariesByName& tracks,
                            const LeftOutScenes& left_out) {
    AtomicFile output(file);
    put_track_boundaries(output.stream(), tracks, left_out);
    output.commit();
}

}  // namespace conelane
