#include "conelane/invalid_input.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/formats/track_spec.hpp"
#include "evaluation/world/scene_generation.hpp"
#include "python/bindings/bindings.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace conelane::python {
namespace {

using Sides = std::optional<std::pair<py::object, py::object>>;

std::shared_ptr<AnnotatedScene> make_scene(const py::object& cones, const py::object& pose,
                                           const py::object& ids, const py::object& colors,
                                           const py::object& confidences, const std::string& id,
                                           const Sides& ground_truth, bool closed, const std::string& track,
                                           const py::object& covariances) {
    auto scene = std::make_shared<AnnotatedScene>();
    scene->scene = {id, python::pose(pose), python::cones(cones, ids, colors, confidences, covariances)};
    validate(scene->scene);
    scene->track = track;
    if (ground_truth) {
        scene->ground_truth =
            Lane{ids_at(ground_truth->first, scene->scene.cones, "ground_truth.left"),
                 ids_at(ground_truth->second, scene->scene.cones, "ground_truth.right"), closed};
    }
    return scene;
}

std::optional<std::pair<Indices, Indices>> ground_truth(const AnnotatedScene& scene) {
    if (!scene.ground_truth) return std::nullopt;
    return std::pair(array(indices_of(scene.ground_truth->left, scene.scene.cones, "ground_truth.left")),
                     array(indices_of(scene.ground_truth->right, scene.scene.cones, "ground_truth.right")));
}

std::vector<std::shared_ptr<AnnotatedScene>> shared(std::vector<AnnotatedScene>&& scenes) {
    std::vector<std::shared_ptr<AnnotatedScene>> all;
    for (AnnotatedScene& scene : scenes) all.push_back(std::make_shared<AnnotatedScene>(std::move(scene)));
    return all;
}

void write_scenes(const std::filesystem::path& file, const std::vector<SceneObject>& scenes) {
    std::vector<AnnotatedScene> all;
    for (const SceneObject& scene : scenes) all.push_back(*scene);
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

constexpr const char* kScene =
    R"(Scene(cones: ArrayLike, pose: ArrayLike, ids: Optional[ArrayLike] = None, colors: Optional[ArrayLike] = None,
      confidences: Optional[ArrayLike] = None, *, id: str = '',
      ground_truth: Optional[Tuple[ArrayLike, ArrayLike]] = None, closed: bool = False, track: str = '',
      covariances: Optional[ArrayLike] = None)

The input of one call of a detector, and the truth for scoring. Every attribute is a copy.

cones, pose, ids, colors, confidences, covariances: As `Detector.detect` takes them.
id: Id of the scene.
ground_truth: The true left and right boundary from the car outward, as indices into `cones`.
closed: Whether that is a whole circuit.
track: Name of its course.

>>> import conelane
>>> scene = conelane.Scene([[0, 1.5], [0, -1.5], [4, 1.5], [4, -1.5]], (0, 0, 0), ground_truth=([0, 2], [1, 3]), id="start")
>>> scene
<conelane.Scene 'start': 4 cones>
)";

constexpr const char* kReadScenes =
    R"(read_scenes(file: Union[str, "PathLike[str]"]) -> List[Scene]

Scenes of a `*.scenes.jsonl` file. A scene without an id gets its line number.
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

Boundaries of the courses of a scenes file, from the `*.tracks.json` file beside it.
Returns by the name of the track.
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
    a run of ft-fsd. A folder instead of the file stands for all its files.
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
condition: "paper", "car" or "harsh": noise, missed cones, and false ones that stay where they are.
with_color: Whether cones show the colours of the track.
seed: The same seed gives the same scenes.
noise_by_range: Standard deviation of the positions for each metre between cone and car, in [0, 1], beside the noise
    of the condition. Above 0 the scenes have `covariances`.

>>> import conelane
>>> track = conelane.load_tracks("generated:circle")[0]
>>> scenes = conelane.generate_scenes(track, false_positive_rate=0.3, every_m=20.0)
>>> scenes[0].track
'circle'
)";

void add_scene(py::module_& module) {
    Class<AnnotatedScene, std::shared_ptr<AnnotatedScene>>(module, "Scene", kScene)
        .init(make_scene)
        .get("id", "str: of the scene", &AnnotatedScene::scene, &Scene::id)
        .get("pose", "NDArray[float64]: (3,), x, y [m] and yaw [rad]", &AnnotatedScene::scene, &Scene::pose,
             kArray)
        .cones(&AnnotatedScene::scene, &Scene::cones)
        .get("color_probabilities",
             "NDArray[float64]: (N, 5), probabilities of unknown, blue, yellow, orange, big orange; 1 and 0 "
             "for a label",
             &AnnotatedScene::scene, &Scene::cones, python::color_probabilities)
        .get("confidences", "NDArray[float64]: (N,), of the detections", &AnnotatedScene::scene,
             &Scene::cones, python::confidences)
        .get("covariances",
             "Optional[NDArray[float64]]: (N, 2, 2), of the positions [m^2]; 0 for a cone without one, None "
             "where no cone has one",
             &AnnotatedScene::scene, &Scene::cones, python::covariances)
        .get("ground_truth",
             "Optional[Tuple[NDArray[int64], NDArray[int64]]]: left and right, as indices into `cones`",
             ground_truth)
        .get("closed", "bool: whether the ground truth is a whole circuit",
             [](const AnnotatedScene& s) { return s.ground_truth && s.ground_truth->closed; })
        .get("track", "str: its name", &AnnotatedScene::track)
        .get("condition", "str: its name", &AnnotatedScene::condition)
        .get("false_positive_rate", "Optional[float]: share of all points",
             &AnnotatedScene::false_positive_rate)
        .get("range_m", "Optional[float]: how far the car sees [m]", &AnnotatedScene::range_m)
        .repr([](const AnnotatedScene& s) {
            return fmt::format("<conelane.Scene '{}': {} cones>", s.scene.id, s.scene.cones.size());
        });
    add_function(module, kReadScenes,
                 [](const std::filesystem::path& file) { return shared(read_scenes(file)); });
    add_function(module, kWriteScenes, write_scenes);
}

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

}  // namespace

void add_scenes(py::module_& module) {
    add_boundaries(module);
    add_scene(module);
    add_track(module);
}

}  // namespace conelane::python
