#include "conelane/invalid_input.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/formats/track_spec.hpp"
#include "evaluation/world/scene_generation.hpp"
#include "python/bindings/arrays.hpp"
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

std::vector<std::shared_ptr<AnnotatedScene>> generate_scenes(const Track& track, double false_positive_rate,
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

void add_scene(py::module_& module) {
    py::class_<AnnotatedScene, std::shared_ptr<AnnotatedScene>> scene(
        module, "Scene",
        R"(Scene(cones, pose, ids=None, colors=None, confidences=None, *, id='', ground_truth=None, closed=False, track='', covariances=None)

The input of one call of a detector, and the truth for scoring. Every attribute is a copy.

Parameters
----------
cones, pose, ids, colors, confidences, covariances
    As `Detector.detect` takes them.
id : str
    Id of the scene.
ground_truth : tuple of two (K,) array_like of int, optional
    The true left and right boundary from the car outward, as indices into `cones`.
closed : bool
    Whether that is a whole circuit.
track : str
    Name of its course.

Examples
--------
>>> import conelane
>>> scene = conelane.Scene([[0, 1.5], [0, -1.5], [4, 1.5], [4, -1.5]], (0, 0, 0), ground_truth=([0, 2], [1, 3]), id="start")
>>> scene
<conelane.Scene 'start': 4 cones>
)");
    scene
        .def(py::init(&make_scene), py::arg("cones"), py::arg("pose"), py::arg("ids") = py::none(),
             py::arg("colors") = py::none(), py::arg("confidences") = py::none(), py::kw_only(),
             py::arg("id") = "", py::arg("ground_truth") = py::none(), py::arg("closed") = false,
             py::arg("track") = "", py::arg("covariances") = py::none())
        .def_property_readonly(
            "id", [](const AnnotatedScene& s) { return s.scene.id; }, "str")
        .def_property_readonly(
            "pose", [](const AnnotatedScene& s) { return array(s.scene.pose); },
            "(3,) ndarray of float64: x, y [m] and yaw [rad]")
        .def_property_readonly(
            "cones", [](const AnnotatedScene& s) { return positions(s.scene.cones); },
            "(N, 2) ndarray of float64: positions [m]")
        .def_property_readonly(
            "ids", [](const AnnotatedScene& s) { return python::ids(s.scene.cones); },
            "(N,) ndarray of int64")
        .def_property_readonly(
            "colors", [](const AnnotatedScene& s) { return python::colors(s.scene.cones); },
            "(N,) ndarray of uint8: codes, see `Color`")
        .def_property_readonly(
            "color_probabilities",
            [](const AnnotatedScene& s) { return python::color_probabilities(s.scene.cones); },
            "(N, 5) ndarray of float64: probabilities of unknown, blue, yellow, orange, big orange; 1 and 0 "
            "for a label")
        .def_property_readonly(
            "confidences", [](const AnnotatedScene& s) { return python::confidences(s.scene.cones); },
            "(N,) ndarray of float64")
        .def_property_readonly(
            "covariances", [](const AnnotatedScene& s) { return python::covariances(s.scene.cones); },
            "(N, 2, 2) ndarray of float64, or None where no cone has one: of the positions [m^2]; 0 for a "
            "cone "
            "without one")
        .def_property_readonly(
            "ground_truth", ground_truth,
            "tuple of two (K,) ndarray of int64, or None: left and right, as indices into `cones`")
        .def_property_readonly(
            "closed", [](const AnnotatedScene& s) { return s.ground_truth && s.ground_truth->closed; },
            "bool: whether the ground truth is a whole circuit")
        .def_property_readonly(
            "track", [](const AnnotatedScene& s) { return s.track; }, "str")
        .def_property_readonly(
            "condition", [](const AnnotatedScene& s) { return s.condition; }, "str")
        .def_property_readonly(
            "false_positive_rate", [](const AnnotatedScene& s) { return s.false_positive_rate; },
            "float or None")
        .def_property_readonly(
            "range_m", [](const AnnotatedScene& s) { return s.range_m; },
            "float or None: how far the car sees [m]")
        .def("__repr__", [](const AnnotatedScene& s) {
            return fmt::format("<conelane.Scene '{}': {} cones>", s.scene.id, s.scene.cones.size());
        });

    module.def(
        "read_scenes", [](const std::filesystem::path& file) { return shared(read_scenes(file)); },
        py::arg("file"), R"(read_scenes(file)

Scenes of a `*.scenes.jsonl` file. A scene without an id gets its line number.

Parameters
----------
file : str or os.PathLike

Returns
-------
list of Scene

Raises
------
ValueError
    Naming file, line and key.
)");
    module.def("write_scenes", write_scenes, py::arg("file"), py::arg("scenes"), R"(write_scenes(file, scenes)

Writes a `*.scenes.jsonl` file. If that fails, an old file stays unchanged.

Parameters
----------
file : str or os.PathLike
scenes : sequence of Scene

Examples
--------
>>> import conelane, os, tempfile
>>> scene = conelane.Scene([[0, 1.5], [0, -1.5]], pose=(0, 0, 0.1), id="start")
>>> with tempfile.TemporaryDirectory() as folder:
...     file = os.path.join(folder, "one.scenes.jsonl")
...     conelane.write_scenes(file, [scene])
...     conelane.read_scenes(file)
[<conelane.Scene 'start': 2 cones>]
)");
}

void add_boundaries(py::module_& module) {
    py::class_<TrackBoundaries>(module, "Boundaries", R"(Boundaries(left, right, closed=True)

The whole annotated boundaries of a course in driving order, from which divergence is measured.

Parameters
----------
left, right : (K, 2) array_like of float
    Positions [m].
closed : bool
    Whether the course is a circuit.
)")
        .def(py::init([](const py::object& left, const py::object& right, bool closed) {
                 return TrackBoundaries{points(left, "left"), points(right, "right"), closed};
             }),
             py::arg("left"), py::arg("right"), py::arg("closed") = true)
        .def_property_readonly(
            "left", [](const TrackBoundaries& b) { return array(b.left); }, "(K, 2) ndarray of float64 [m]")
        .def_property_readonly(
            "right", [](const TrackBoundaries& b) { return array(b.right); }, "(K, 2) ndarray of float64 [m]")
        .def_property_readonly(
            "closed", [](const TrackBoundaries& b) { return b.closed; }, "bool")
        .def_property_readonly(
            "driven", [](const TrackBoundaries& b) { return array(b.driven); },
            "(K, 2) ndarray of float64: the driven path [m] of a run without boundaries");

    module.def("read_boundaries", read_track_boundaries, py::arg("file"),
               R"(read_boundaries(file)

Boundaries of the courses of a scenes file, from the `*.tracks.json` file beside it.

Parameters
----------
file : str or os.PathLike

Returns
-------
dict of str to Boundaries
    By the name of the track.

Raises
------
ValueError
    Naming file and key.
)");
    module.def("write_boundaries", write_track_boundaries, py::arg("file"), py::arg("boundaries"),
               R"(write_boundaries(file, boundaries)

Writes a `*.tracks.json` file. If that fails, an old file stays unchanged.

Parameters
----------
file : str or os.PathLike
boundaries : dict of str to Boundaries

Examples
--------
>>> import conelane, os, tempfile
>>> track = conelane.load_tracks("generated:circle")[0]
>>> with tempfile.TemporaryDirectory() as folder:
...     file = os.path.join(folder, "circle.tracks.json")
...     conelane.write_boundaries(file, {track.name: track.boundaries})
...     len(conelane.read_boundaries(file)[track.name].left) == len(track.left)
True
)");
}

void add_track(py::module_& module) {
    py::class_<Track>(module, "Track", "A map of cones with annotated boundaries. Every attribute is a copy.")
        .def_property_readonly(
            "name", [](const Track& t) { return t.name; }, "str: such as \"fsd_1\"")
        .def_property_readonly(
            "cones", [](const Track& t) { return positions(t.cones); },
            "(N, 2) ndarray of float64: positions [m]")
        .def_property_readonly(
            "ids", [](const Track& t) { return python::ids(t.cones); }, "(N,) ndarray of int64")
        .def_property_readonly(
            "colors", [](const Track& t) { return python::colors(t.cones); },
            "(N,) ndarray of uint8: codes, see `Color`")
        .def_property_readonly(
            "left", [](const Track& t) { return track_indices(t.left); },
            "(K,) ndarray of int64: the left boundary in driving order, as indices into `cones`")
        .def_property_readonly(
            "right", [](const Track& t) { return track_indices(t.right); },
            "(K,) ndarray of int64: the right boundary")
        .def_property_readonly(
            "closed", [](const Track& t) { return t.closed; }, "bool: a circuit")
        .def_property_readonly(
            "warnings", [](const Track& t) { return t.warnings; },
            "list of str: facts about the recording that a user should know")
        .def_property_readonly(
            "boundaries",
            [](const Track& t) {
                TrackBoundaries all = boundaries(t);
                if (all.driven.empty()) all.driven = t.driven;
                return all;
            },
            "Boundaries")
        .def("__repr__", [](const Track& t) {
            return fmt::format("<conelane.Track '{}': {} cones>", t.name, t.cones.size());
        });

    module.def(
        "load_tracks",
        [](const std::string& spec) {
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
        },
        py::arg("spec"), R"(load_tracks(spec)

Tracks from files of several formats, or generated ones.

Parameters
----------
spec : str
    "generated:NAME" (straight, circle, ...), "fsd:DIR" or "fsd:DIR:1,2", "pacsim:FILE", "eufs:FILE",
    "ftlog:FILE", a run of ft-fsd. A folder instead of the file stands for all its files.

Returns
-------
list of Track

Raises
------
ValueError
    Naming the file, or the spec.

Warns
-----
UserWarning
    For each of the `warnings` of a track.

Examples
--------
>>> import conelane
>>> conelane.load_tracks("generated:straight")
[<conelane.Track 'straight': 126 cones>]
)");
    module.def(
        "generate_scenes", generate_scenes, py::arg("track"), py::kw_only(),
        py::arg("false_positive_rate") = 0.0, py::arg("range_m") = 30.0, py::arg("every_m") = 1.1,
        py::arg("condition") = py::none(), py::arg("with_color") = false, py::arg("seed") = 0,
        py::arg("noise_by_range") = py::none(),
        R"(generate_scenes(track, *, false_positive_rate=0.0, range_m=30.0, every_m=1.1, condition=None, with_color=False, seed=0, noise_by_range=None)

What a car sees along a track, with the true lane.

Parameters
----------
track : Track
false_positive_rate : float
    Share of false cones among all points of a scene, in [0, 0.99].
range_m : float
    Radius of the half disc ahead that is visible [m].
every_m : float
    Travel from scene to scene [m].
condition : str, optional
    "paper", "car" or "harsh": noise, missed cones, and false ones that stay where they are.
with_color : bool
    Whether cones show the colours of the track.
seed : int
    The same seed gives the same scenes.
noise_by_range : float, optional
    Standard deviation of the positions for each metre between cone and car, in [0, 1], beside the noise of the
    condition. Above 0 the scenes have `covariances`.

Returns
-------
list of Scene

Examples
--------
>>> import conelane
>>> track = conelane.load_tracks("generated:circle")[0]
>>> scenes = conelane.generate_scenes(track, false_positive_rate=0.3, every_m=20.0)
>>> scenes[0].track
'circle'
)");
}

}  // namespace

void add_scenes(py::module_& module) {
    add_boundaries(module);
    add_scene(module);
    add_track(module);
}

}  // namespace conelane::python
