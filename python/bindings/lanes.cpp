#include "conelane/drivable_lane.hpp"
#include "conelane/invalid_input.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/outside/point_snapping.hpp"
#include "evaluation/scoring/score.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace conelane::python {
namespace {

std::vector<Point> boundary(const LaneObject& lane, bool left) {
    if (lane.record.points) return left ? lane.record.points->left : lane.record.points->right;
    const std::vector<ConeId>& ids = left ? lane.record.answer.lane.left : lane.record.answer.lane.right;
    std::vector<Point> points;
    for (const std::int64_t i : indices_of(ids, lane.scene->cones, left ? "left" : "right"))
        points.push_back(lane.scene->cones[static_cast<std::size_t>(i)].position);
    return points;
}

Indices boundary_indices(const LaneObject& lane, bool left) {
    const Lane& ids = lane.record.answer.lane;
    return array(indices_of(left ? ids.left : ids.right, lane.scene->cones, left ? "left" : "right"));
}

/// The answer with cones: for a lane of positions, cones are made.
std::pair<LaneAnswer, Scene> as_cones(const LaneObject& lane) {
    LaneAnswer answer = lane.record.answer;
    Scene scene{lane.scene->id, lane.scene->pose, {}};
    for (const bool left : {true, false}) {
        std::vector<ConeId>& ids = left ? answer.lane.left : answer.lane.right;
        for (const Point& point : boundary(lane, left)) {
            ids.push_back(static_cast<ConeId>(scene.cones.size()));
            scene.cones.push_back({ids.back(), point});
        }
    }
    return {std::move(answer), std::move(scene)};
}

DrivableLane drivable(const LaneObject& lane, const DrivableOptions& options) {
    const py::gil_scoped_release unlocked;
    if (!lane.record.points) return conelane::drivable(lane.record.answer, *lane.scene, options);
    const auto [answer, scene] = as_cones(lane);
    return conelane::drivable(answer, scene, options);
}

std::vector<LaneObject> read_lanes(const std::filesystem::path& file,
                                   const std::vector<SceneObject>& scenes) {
    std::unordered_map<std::string, SceneObject> scene_of;  // for look-up only
    for (const SceneObject& scene : scenes) scene_of.emplace(scene->scene.id, scene);
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
    for (const LaneObject* lane : lanes) records.push_back(lane->record);
    conelane::write_lanes(file, records);
}

std::optional<double> objective(const LaneObject& lane) {
    if (!lane.record.answer.optimality) return std::nullopt;
    return lane.record.answer.optimality->objective;
}

void add_answer(py::class_<LaneObject>& lane) {
    lane.def_property_readonly(
            "status", [](const LaneObject& l) { return to_string(l.record.answer.status); },
            R"(str: "found"; "none": there is no lane, by proof or complete search; "stopped": a limit ended the search before
a lane that can be driven was found; "error": see `message`.)")
        .def_property_readonly(
            "found", [](const LaneObject& l) { return l.record.answer.status == LaneStatus::found; },
            "bool: whether the status is \"found\"")
        .def_property_readonly(
            "message", [](const LaneObject& l) { return l.record.answer.message; },
            "str: of an error, or of a lane that is stopped because it cannot be driven")
        .def_property_readonly(
            "stopped_by",
            [](const LaneObject& l) -> std::optional<std::string_view> {
                if (!l.record.answer.stopped_by) return std::nullopt;
                return to_string(*l.record.answer.stopped_by);
            },
            R"(str or None: the limit that ended the search: "time", "iterations" or "memory")")
        .def_property_readonly(
            "confidence", [](const LaneObject& l) { return l.record.answer.confidence; },
            "float or None: probability that the lane is usable; None if the detector has none")
        .def_property_readonly(
            "trusted_m", [](const LaneObject& l) { return l.record.answer.trusted_m; },
            R"(float or None: distance up to which the lane can be trusted [m]. A lane found by `Detector` always has one:
with a `confidence` it follows from probabilities, without one from a rule, 10 m at most. None if no lane was
found, or if a file does not have it: do not trust that lane.)")
        .def_property_readonly(
            "merged",
            [](const LaneObject& l) {
                py::dict merged;
                for (const auto& [cone, into] : l.record.answer.merged) merged[py::int_(cone)] = into;
                return merged;
            },
            R"(dict of int to int: ids of the cones that the detector left out, because each is within 0.12 m of another
cone (front, front-warm: 0.35 m), and the id that represents both; empty for a lane from a file)")
        .def_property_readonly("objective", objective, "float or None: of a detector that states one")
        .def_property_readonly(
            "bound",
            [](const LaneObject& l) -> std::optional<double> {
                if (!l.record.answer.optimality) return std::nullopt;
                return l.record.answer.optimality->bound;
            },
            "float or None: proven lower bound of the objective")
        .def_property_readonly(
            "latency_ms", [](const LaneObject& l) { return l.record.latency_ms; },
            "float: wall clock of the search [ms]")
        .def_property_readonly(
            "method", [](const LaneObject& l) { return l.record.detector; }, "str: name of the detector")
        .def_property_readonly(
            "scene_id", [](const LaneObject& l) { return l.record.scene; },
            "str: id of the scene that it answers; empty for arrays");
}

void add_geometry(py::class_<LaneObject>& lane) {
    lane.def_property_readonly(
            "left", [](const LaneObject& l) { return boundary_indices(l, true); },
            R"((L,) ndarray of int64: the cones of the left boundary from the car outward, as indices into `cones`; empty
if no lane, or only the right boundary, was found.)")
        .def_property_readonly(
            "right", [](const LaneObject& l) { return boundary_indices(l, false); },
            "(R,) ndarray of int64: the same for the right boundary")
        .def_property_readonly(
            "left_points", [](const LaneObject& l) { return array(boundary(l, true)); },
            "(L, 2) ndarray of float64: the left boundary's positions [m]")
        .def_property_readonly(
            "right_points", [](const LaneObject& l) { return array(boundary(l, false)); },
            "(R, 2) ndarray of float64: the right boundary's positions [m]")
        .def_property_readonly(
            "closed", [](const LaneObject& l) { return l.record.answer.lane.closed; },
            "bool: a whole circuit, in which each boundary returns from its last cone to its first")
        .def_property_readonly(
            "cones", [](const LaneObject& l) { return positions(l.scene->cones); },
            "(N, 2) ndarray of float64: all cones that the detector was given [m]")
        .def_property_readonly(
            "ids", [](const LaneObject& l) { return python::ids(l.scene->cones); },
            "(N,) ndarray of int64: ids of those cones")
        .def_property_readonly(
            "colors", [](const LaneObject& l) { return python::colors(l.scene->cones); },
            "(N,) ndarray of uint8: codes, see `Color`")
        .def_property_readonly(
            "pose", [](const LaneObject& l) { return array(l.scene->pose); },
            "(3,) ndarray of float64: x, y [m] and yaw [rad] of the car")
        .def(
            "centre_line",
            [](const LaneObject& l, double step_m, double smoothing_m, double usual_width_m) {
                try {
                    return array(drivable(
                        l, {.step_m = step_m, .smoothing_m = smoothing_m, .default_width_m = usual_width_m}));
                } catch (const InvalidInput& error) {
                    if (error.key() != "default_width_m") throw;
                    throw InvalidInput("usual_width_m",
                                       std::string(error.what()).substr(error.key().size() + 2));
                }
            },
            py::arg("step_m") = DrivableOptions{}.step_m, py::kw_only(),
            py::arg("smoothing_m") = DrivableOptions{}.smoothing_m,
            py::arg("usual_width_m") = DrivableOptions{}.default_width_m,
            R"(centre_line(step_m=0.5, *, smoothing_m=1.75, usual_width_m=3.5)

The middle of the lane from the car on.

Parameters
----------
step_m : float
    Arc length from point to point [m], in [0.01, 100].
smoothing_m : float
    Length scale of the smoothing [m], in [0.25, 5].
usual_width_m : float
    Width of a lane of which only one boundary was found [m], in [1, 6.5].

Returns
-------
(M, 7) ndarray of float64
    Columns: s, the arc length from the car's foot point [m]; x, y [m]; heading [rad], in (-pi, pi]; curvature
    [1/m], positive in a left bend; distance to the left and to the right boundary [m]. M is 0 if there is
    no lane.

Examples
--------
>>> import conelane
>>> cones = [[0, -1.5], [0, 1.5], [4, -1.5], [4, 1.5], [8, -1.5], [8, 1.5]]
>>> line = conelane.Detector("front").detect(cones, (0, 0, 0)).centre_line(step_m=2)
>>> line.shape
(5, 7)
>>> line[:, 0].tolist()
[0.0, 2.0, 4.0, 6.0, 8.0]
)")
        .def(
            "drivable",
            [](const LaneObject& l, double step_m, double smoothing_m, double max_gap_m,
               double default_width_m) {
                return drivable(l, {step_m, smoothing_m, max_gap_m, default_width_m});
            },
            py::arg("step_m") = DrivableOptions{}.step_m, py::kw_only(),
            py::arg("smoothing_m") = DrivableOptions{}.smoothing_m,
            py::arg("max_gap_m") = DrivableOptions{}.max_gap_m,
            py::arg("default_width_m") = DrivableOptions{}.default_width_m,
            R"(drivable(step_m=0.5, *, smoothing_m=1.75, max_gap_m=5.5, default_width_m=3.5)

The centre line with the gaps that it bridges and the boundary that was inferred.

Parameters
----------
step_m, smoothing_m : float
    As of `centre_line`.
max_gap_m : float
    Longer gaps of a boundary are reported as bridged [m].
default_width_m : float
    The `usual_width_m` of `centre_line`.

Returns
-------
DrivableLane
)")
        .def(
            "plot",
            [](const py::object& self, const py::object& ax) {
                return py::module_::import("conelane._plot").attr("plot_lane")(self, ax);
            },
            py::arg("ax") = py::none(), R"(plot(ax=None)

Draws cones, both boundaries, the centre line and the car. Needs matplotlib.

Parameters
----------
ax : matplotlib.axes.Axes, optional
    By default those of the current figure.

Returns
-------
matplotlib.axes.Axes
)")
        .def("__repr__", [](const LaneObject& l) {
            const LaneRecord& record = l.record;
            return fmt::format("<conelane.Lane {}: {} left, {} right of {} cones>",
                               to_string(record.answer.status),
                               record.points ? record.points->left.size() : record.answer.lane.left.size(),
                               record.points ? record.points->right.size() : record.answer.lane.right.size(),
                               l.scene->cones.size());
        });
}

void add_drivable_lane(py::module_& module) {
    py::class_<DrivableLane>(module, "DrivableLane",
                             R"(A lane ready to be driven. Every attribute is a copy.)")
        .def_property_readonly(
            "centre_line", [](const DrivableLane& d) { return array(d); },
            "(N, 7) ndarray of float64: columns as of `Lane.centre_line`")
        .def_readonly("closed", &DrivableLane::closed, "bool: the last row is one step before the first one")
        .def_readonly("length_m", &DrivableLane::length_m, "float: of the centre line [m]")
        .def_readonly("trusted_m", &DrivableLane::trusted_m,
                      "float or None: arc length up to which the detector trusts the lane [m]")
        .def_property_readonly(
            "bridged",
            [](const DrivableLane& d) {
                py::list gaps;
                for (const BridgedGap& gap : d.bridged)
                    gaps.append(py::make_tuple(gap.on_left ? "left" : "right", gap.from_s_m, gap.to_s_m));
                return gaps;
            },
            R"(list of (str, float, float): gaps between successive cones longer than `max_gap_m`, in which a cone is
missing or was not seen: "left" or "right", and the arc lengths beside the two cones [m])")
        .def_readonly("left_inferred", &DrivableLane::left_inferred,
                      "bool: no cone of the left boundary is known, it is assumed at `default_width_m`")
        .def_readonly("right_inferred", &DrivableLane::right_inferred,
                      "bool: the same for the right boundary");
}

}  // namespace

void add_lanes(py::module_& module) {
    add_drivable_lane(module);
    py::class_<LaneObject> lane(module, "Lane", R"(The answer of a detector. Every attribute is a copy.)");
    add_geometry(lane);
    add_answer(lane);

    module.def("read_lanes", read_lanes, py::arg("file"), py::arg("scenes"), R"(read_lanes(file, scenes)

Lanes of a `*.lanes.jsonl` file.

Parameters
----------
file : str or os.PathLike
scenes : sequence of Scene
    The scenes of the lanes, found by id.

Returns
-------
list of Lane

Raises
------
ValueError
    Naming file, line and key.
)");
    module.def("write_lanes", write_lanes, py::arg("file"), py::arg("lanes"), R"(write_lanes(file, lanes)

Writes a `*.lanes.jsonl` file. If that fails, an old file stays unchanged.

Parameters
----------
file : str or os.PathLike
lanes : sequence of Lane

Examples
--------
>>> import conelane, os, tempfile
>>> scenes = conelane.generate_scenes(conelane.load_tracks("generated:circle")[0], every_m=20.0)
>>> detector = conelane.Detector("front")
>>> lanes = [detector.detect_scene(scene) for scene in scenes]
>>> with tempfile.TemporaryDirectory() as folder:
...     file = os.path.join(folder, "circle.lanes.jsonl")
...     conelane.write_lanes(file, lanes)
...     again = conelane.read_lanes(file, scenes)
>>> [a.left.tolist() for a in again] == [a.left.tolist() for a in lanes]
True
)");
}

}  // namespace conelane::python
