#include "evaluation/formats/scene_file.hpp"
#include "evaluation/formats/track_spec.hpp"
#include "evaluation/outside/point_snapping.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/world/scene_generation.hpp"
#include "python/bindings/bindings.hpp"

#include <unordered_set>

#include <fmt/format.h>
#include <pybind11/stl/filesystem.h>

// Files, courses and scores: what a build of the core alone leaves out.
namespace conelane::python {
namespace {

std::vector<std::shared_ptr<AnnotatedScene>> shared(std::vector<AnnotatedScene>&& scenes) {
    std::vector<std::shared_ptr<AnnotatedScene>> all;
    for (AnnotatedScene& scene : scenes) all.push_back(std::make_shared<AnnotatedScene>(std::move(scene)));
    return all;
}

void write_scenes(const std::filesystem::path& file, const std::vector<SceneObject>& scenes) {
    std::vector<AnnotatedScene> all;
    std::unordered_set<std::string> ids;
    for (const SceneObject& scene : scenes) {
        const auto& [id, pose, cones] = required(scene, "scenes")->scene;
        if (cones.empty()) throw InvalidInput("scenes", "'" + id + "' has no cone, files need one");
        if (!id.empty() && !ids.insert(id).second)
            throw InvalidInput("scenes", "two scenes have the id '" + id + "'");
        all.push_back(*scene);
    }
    conelane::write_scenes(file, all);
}

std::vector<std::shared_ptr<AnnotatedScene>> scenes_along(const Track& track, double false_positive_rate,
                                                          double range_m, double every_m,
                                                          const std::optional<std::string>& condition,
                                                          bool with_color, std::uint64_t seed,
                                                          std::optional<double> noise_by_range) {
    SceneOptions options;
    options.false_positive_rates = {false_positive_rate};
    options.ranges_m = {range_m};
    options.every_m = every_m;
    if (condition) options.conditions = {*condition};
    options.with_color = with_color;
    options.seed = seed;
    options.noise_by_range = noise_by_range;
    const py::gil_scoped_release unlocked;
    validate(options);
    return shared(generate_scenes(track, options));
}

Indices track_indices(const std::vector<std::size_t>& indices) {
    const std::vector<std::int64_t> values(indices.begin(), indices.end());
    return array(values);
}

std::vector<Track> load_tracks_warning(const std::string& spec) {
    std::vector<Track> tracks;
    {
        const py::gil_scoped_release release;
        tracks = load_tracks(spec);
    }
    for (const Track& track : tracks) {
        for (const std::string& warning : track.warnings) {
            const std::string text = track.name + ": " + warning;
            if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) throw py::error_already_set();
        }
    }
    return tracks;
}

std::vector<LaneObject> read_lanes(const std::filesystem::path& file,
                                   const std::vector<SceneObject>& scenes) {
    std::unordered_map<std::string, SceneObject> scene_of;  // for look-up only
    for (const SceneObject& scene : scenes) {
        const std::string& id = required(scene, "scenes")->scene.id;
        if (scene_of.emplace(id, scene).first->second != scene)
            throw InvalidInput("scenes", "two scenes have the id '" + id + "'");
    }
    std::vector<LaneObject> lanes;
    for (LaneRecord& record : conelane::read_lanes(file)) {
        const auto found = scene_of.find(record.scene);
        if (found == scene_of.end()) {
            throw InputError(file, record.line, "scene",
                             "'" + record.scene + "' is not one of the scenes given");
        }
        const Scene& scene = found->second->scene;
        snap_to_cones(record, scene);
        if (const std::string fault = fault_of(record, scene); !fault.empty())
            throw InputError(file, record.line, "", fault);
        lanes.push_back({std::move(record), {found->second, &scene}});
    }
    return lanes;
}

void write_lanes(const std::filesystem::path& file, const std::vector<const LaneObject*>& lanes) {
    std::vector<LaneRecord> records;
    for (const LaneObject* lane : lanes) records.push_back(required(lane, "lanes")->record);
    conelane::write_lanes(file, records);
}

constexpr const char* kReadScenes =
    R"(read_scenes(file: Union[str, "PathLike[str]"]) -> List[Scene]

Scenes of a `*.scenes.jsonl` file. A scene without an id gets its line number, from 1.
Raises ValueError, naming file, line and key.
)";

constexpr const char* kWriteScenes =
    R"(write_scenes(file: Union[str, "PathLike[str]"], scenes: Sequence[Scene]) -> None

Writes a `*.scenes.jsonl` file. If that fails, an old file stays unchanged.

>>> import conelane, os, tempfile
>>> scene = conelane.Scene([[0, 1.5], [0, -1.5]], pose=(0, 0, 0.1), id="start")
>>> with tempfile.TemporaryDirectory() as folder:
...     file = os.path.join(folder, "one.scenes.jsonl")
...     conelane.write_scenes(file, [scene])
...     conelane.read_scenes(file)
[<conelane.Scene 'start': 2 cones>]
)";

constexpr const char* kBoundaries =
    R"(Boundaries(left: ArrayLike, right: ArrayLike, closed: bool = True)

The whole annotated boundaries of a course in driving order, from which divergence is measured.

left, right: (K, 2), positions [m].
closed: Whether the course is a circuit.
)";

constexpr const char* kReadBoundaries =
    R"(read_boundaries(file: Union[str, "PathLike[str]"]) -> Dict[str, Boundaries]

Boundaries of courses, by the name of the track. `file` is the `*.tracks.json` file beside a scenes file.
Raises ValueError, naming file and key.
)";

constexpr const char* kWriteBoundaries =
    R"(write_boundaries(file: Union[str, "PathLike[str]"], boundaries: Dict[str, Boundaries]) -> None

Writes a `*.tracks.json` file. If that fails, an old file stays unchanged.
)";

constexpr const char* kLoadTracks =
    R"(load_tracks(spec: str) -> List[Track]

Tracks from files of several formats, or generated ones.

spec: "generated:NAME" (straight, circle, ...), "fsd:DIR" or "fsd:DIR:1,2", "pacsim:FILE", "eufs:FILE", "ftlog:FILE",
    a run of ft-fsd, "run:FILE", a run of frames, labelled by the path that was driven. A folder instead of the file stands for all its files.
Raises ValueError, naming the file, or the spec.
Warns (UserWarning) for each of the `warnings` of a track.

>>> import conelane
>>> conelane.load_tracks("generated:straight")
[<conelane.Track 'straight': 126 cones>]
)";

constexpr const char* kGenerateScenes =
    R"(generate_scenes(track: Track, *, false_positive_rate: float = 0.0, range_m: float = 30.0, every_m: float = 1.1,
                condition: Optional[str] = None, with_color: bool = False, seed: int = 0,
                noise_by_range: Optional[float] = None) -> List[Scene]

What a car sees along a track, with the true lane.

false_positive_rate: Share of false cones among all points of a scene, in [0, 0.99].
range_m: Radius of the half disc ahead that is visible [m].
every_m: Travel from scene to scene [m].
condition: "paper", undisturbed; "car", "harsh" or "slam": noise, missed cones, false ones that stay in place.
with_color: Whether cones show the colours of the track.
seed: The same seed gives the same scenes.
noise_by_range: Standard deviation of the positions for each metre between cone and car, in [0, 1], in addition to the
    noise of the condition. Above 0 the scenes have `covariances`.

>>> import conelane
>>> track = conelane.load_tracks("generated:circle")[0]
>>> scenes = conelane.generate_scenes(track, false_positive_rate=0.3, every_m=20.0)
>>> scenes[0].track
'circle'
)";

constexpr const char* kReadLanes =
    R"(read_lanes(file: Union[str, "PathLike[str]"], scenes: Sequence[Scene]) -> List[Lane]

Lanes of a `*.lanes.jsonl` file.

scenes: The scenes of the lanes, found by id.
Raises ValueError, naming file, line and key.
)";

constexpr const char* kWriteLanes =
    R"(write_lanes(file: Union[str, "PathLike[str]"], lanes: Sequence[Lane]) -> None

Writes a `*.lanes.jsonl` file. If that fails, an old file stays unchanged.
)";

void add_boundaries(py::module_& module) {
    Class<TrackBoundaries>(module, "Boundaries", kBoundaries)
        .init([](const py::object& left, const py::object& right, bool closed) {
            return TrackBoundaries{points(left, "left"), points(right, "right"), closed};
        })
        .get("left", "NDArray[float64]: (K, 2), positions [m]", &TrackBoundaries::left, kArray)
        .get("right", "NDArray[float64]: (K, 2), positions [m]", &TrackBoundaries::right, kArray)
        .get("closed", "bool: a circuit", &TrackBoundaries::closed)
        .get("driven", "NDArray[float64]: (K, 2), the driven path [m] of a run without boundaries",
             &TrackBoundaries::driven, kArray);
    add_function(module, kReadBoundaries, read_track_boundaries);
    add_function(module, kWriteBoundaries, write_track_boundaries);
}

void add_track(py::module_& module) {
    Class<Track>(module, "Track", "A map of cones with annotated boundaries. Every attribute is a copy.")
        .get("name", "str: such as \"fsd_1\"", &Track::name)
        .cones(&Track::cones)
        .get("left", "NDArray[int64]: (K,), the left boundary in driving order, as indices into `cones`",
             &Track::left, track_indices)
        .get("right", "NDArray[int64]: (K,), the right boundary", &Track::right, track_indices)
        .get("closed", "bool: a circuit", &Track::closed)
        .get("warnings", "List[str]: facts about the recording that a user should know", &Track::warnings)
        .get("boundaries", "Boundaries: of the course",
             [](const Track& t) {
                 TrackBoundaries all = boundaries(t);
                 if (all.driven.empty()) all.driven = t.driven;
                 return all;
             })
        .repr([](const Track& t) {
            return fmt::format("<conelane.Track '{}': {} cones>", t.name, t.cones.size());
        });
    add_function(module, kLoadTracks, load_tracks_warning);
    add_function(module, kGenerateScenes, scenes_along);
}

CentreLine line_of(const LaneObject& lane, const AnnotatedScene& scene) {
    const LaneRecord& record = lane.record;
    const Pose& pose = scene.scene.pose;
    if (record.points) {
        return centre_line_of(
            LaneOutline{record.points->left, record.points->right, record.answer.lane.closed}, pose);
    }
    if (!record.centre_line.empty()) return centre_line_of(record.centre_line, pose);
    return centre_line_of(outline_of(record.answer.lane, scene.scene), pose);
}

SceneScore score_of(const LaneObject& lane, const AnnotatedScene& scene, const TrackBoundaries* boundaries) {
    const LaneRecord& record = lane.record;
    if (record.points) {
        return score_outline(scene, {record.points->left, record.points->right, record.answer.lane.closed},
                             record.latency_ms, boundaries);
    }
    if (!record.centre_line.empty())
        return score_centre_line(scene, record.centre_line, record.latency_ms, boundaries);
    return score(scene, record.answer, record.latency_ms, record.nearest, boundaries);
}

SceneScore score(const AnnotatedScene& scene, const LaneObject& lane, const TrackBoundaries* boundaries) {
    const py::gil_scoped_release unlocked;
    conelane::validate(scene.scene);
    SceneScore score = score_of(lane, scene, boundaries);
    if (score.usable().value_or(false) && scene.ground_truth) {
        const auto truth = centre_line_of(outline_of(*scene.ground_truth, scene.scene), scene.scene.pose);
        score.centre_line_error = centre_line_error(line_of(lane, scene), truth);
    }
    return score;
}

std::optional<bool> accurate(const SceneScore& score) {
    if (!score.accuracy) return std::nullopt;
    return score.accuracy->accurate();
}

std::optional<py::array_t<float>> lateral_error_m(const SceneScore& score) {
    if (!score.centre_line_error) return std::nullopt;
    const std::vector<float>& values = score.centre_line_error->lateral_m;
    return py::array_t<float>(static_cast<py::ssize_t>(values.size()), values.data());
}

std::optional<double> heading_error_rad(const SceneScore& score) {
    if (!score.centre_line_error) return std::nullopt;
    return score.centre_line_error->heading_rad;
}

constexpr const char* kScore =
    R"(score(scene: Scene, lane: Lane, boundaries: Optional[Boundaries] = None) -> Score

Compares a lane with the true one. The measures are defined in docs/measures.md.

scene: With a ground truth, or of a run whose boundaries have the driven path.
lane: Of this scene: cones are compared by their ids.
boundaries: Of the whole course. Without them divergence is unknown, and `usable` is None.
Raises ValueError if the scene has neither a ground truth with two cones on each side nor 5 m of a driven path, or if the
    lane names a cone that the scene does not have.

>>> import conelane
>>> track = conelane.load_tracks("generated:circle")[0]
>>> scene = conelane.generate_scenes(track, every_m=20.0)[0]
>>> result = conelane.score(scene, conelane.Detector("front").detect_scene(scene), track.boundaries)
>>> result.usable, result.category
(True, 'ground_truth')
)";

void add_score(py::module_& module) {
    Class<SceneScore>(module, "Score", "What one lane is worth, by the measures of both papers.")
        .get("usable", "Optional[bool]: whether a car can drive by the lane; None without boundaries",
             &SceneScore::usable)
        .get(
            "category",
            R"(str: "none", "ground_truth", "diverging_below_20", "diverging_from_20", "too_short" or "near_ground_truth")",
            &SceneScore::category, kName)
        .get("success", "bool: any category but none and diverging_below_20", &SceneScore::success)
        .get("accurate", "Optional[bool]: passes the four checks of the RLD paper; None if they do not apply",
             accurate)
        .get("error", "bool: the detector failed", &SceneScore::error)
        .get("iou", "Optional[float]: intersection over union with the true lane, in [0, 1]",
             &SceneScore::iou)
        .get("lane_length_m", "float: of the lane [m]", &SceneScore::lane_length_m)
        .get("ground_truth_length_m", "float: of the true lane [m]", &SceneScore::ground_truth_length_m)
        .get("divergence_distance_m",
             "Optional[float]: distance at which the lane leaves the course [m]; None if unknown or never",
             &SceneScore::divergence_distance_m)
        .get("lateral_error_m",
             "Optional[NDArray[float32]]: (K,), lateral error of the centre line every 0.5 m [m]; for usable "
             "lanes",
             lateral_error_m)
        .get("heading_error_rad",
             "Optional[float]: heading error of the centre line 10 m ahead [rad]; for usable lanes",
             heading_error_rad)
        .repr([](const SceneScore& s) { return fmt::format("<conelane.Score {}>", to_string(s.category)); });

    add_function(module, kScore, score);
}

}  // namespace

void add_files(py::module_& module) {
    add_boundaries(module);
    add_track(module);
    add_score(module);
    add_function(module, kReadScenes,
                 [](const std::filesystem::path& file) { return shared(read_scenes(file)); });
    add_function(module, kWriteScenes, write_scenes);
    add_function(module, kReadLanes, read_lanes);
    add_function(module, kWriteLanes, write_lanes);
}

}  // namespace conelane::python
