#include "conelane/planner.hpp"

#include "conelane/invalid_input.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"

#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <pybind11/stl.h>

namespace conelane::python {
namespace {

struct PlanObject {
    Plan plan;
    double latency_ms = 0.0;
};

/// A planner that may be called from any thread: calls of one instance wait for each other.
class PlannerObject {
  public:
    explicit PlannerObject(const PlannerOptions& options)
        : mission_(options.mission), detector_(options.detector), planner_(make_planner(options)) {}

    [[nodiscard]] PlanObject update(const Frame& frame, std::optional<double> time_limit_ms) {
        const double limit_ms = time_limit_ms.value_or(std::numeric_limits<double>::infinity());
        PlanObject result;
        const py::gil_scoped_release unlocked;  // before the mutex: its owner may need this lock to finish
        const std::scoped_lock lock(mutex_);
        const auto start = std::chrono::steady_clock::now();
        result.plan = planner_->update(frame, {.time_limit_ms = limit_ms});
        const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
        result.latency_ms = took.count();
        return result;
    }

    [[nodiscard]] std::optional<DrivableLane> course() {
        const py::gil_scoped_release unlocked;
        const std::scoped_lock lock(mutex_);
        return planner_->course();
    }

    void reset() {
        const py::gil_scoped_release unlocked;
        const std::scoped_lock lock(mutex_);
        planner_->reset();
    }

    [[nodiscard]] Mission mission() const { return mission_; }
    [[nodiscard]] const std::string& detector() const { return detector_; }

  private:
    Mission mission_;
    std::string detector_;
    std::unique_ptr<Planner> planner_;
    std::mutex mutex_;
};

double time_of(py::handle object) {
    const double time_s = PyFloat_AsDouble(object.ptr());
    if (time_s == -1.0 && PyErr_Occurred() != nullptr) {
        PyErr_Clear();
        throw InvalidInput("time_s", "is not a number");
    }
    return time_s;
}

void add_answer(py::module_& module) {
    py::class_<LaneAnswer>(module, "Answer", R"(The detector's answer to a frame.)")
        .def_property_readonly(
            "status", [](const LaneAnswer& a) { return to_string(a.status); }, "str: as of `Lane.status`")
        .def_property_readonly(
            "found", [](const LaneAnswer& a) { return a.status == LaneStatus::found; },
            "bool: whether the status is \"found\"")
        .def_property_readonly(
            "message", [](const LaneAnswer& a) { return a.message; }, "str: as of `Lane.message`")
        .def_property_readonly(
            "stopped_by",
            [](const LaneAnswer& a) -> std::optional<std::string_view> {
                if (!a.stopped_by) return std::nullopt;
                return to_string(*a.stopped_by);
            },
            R"(str or None: the limit that ended the search: "time", "iterations" or "memory")")
        .def_property_readonly(
            "confidence", [](const LaneAnswer& a) { return a.confidence; },
            "float or None: probability that the lane is usable; None if the detector has none")
        .def_property_readonly(
            "trusted_m", [](const LaneAnswer& a) { return a.trusted_m; },
            "float or None: distance up to which the lane can be trusted [m]")
        .def_property_readonly(
            "left_ids", [](const LaneAnswer& a) { return array(a.lane.left); },
            R"((L,) ndarray of int64: cones of the left boundary from the car outward, by the ids of the frames; a
cone without an id has a negative id of the planner's own)")
        .def_property_readonly(
            "right_ids", [](const LaneAnswer& a) { return array(a.lane.right); },
            "(R,) ndarray of int64: the same for the right boundary")
        .def("__repr__", [](const LaneAnswer& a) {
            return fmt::format("<conelane.Answer {}: {} left, {} right>", to_string(a.status),
                               a.lane.left.size(), a.lane.right.size());
        });
}

void add_plan(py::module_& module) {
    py::class_<PlanObject>(module, "Plan", R"(The path to drive. Every attribute is a copy.)")
        .def_property_readonly(
            "state", [](const PlanObject& p) { return to_string(p.plan.state); },
            R"(str: "searching": no lane has been found yet; "following": the lane is of this frame; "bridging": no lane in
this frame, so the rest of an earlier one; "lost": no earlier lane is left, so there is no path: brake;
"finished": the last line is crossed, and the lane is the stretch on which to come to rest.)")
        .def_property_readonly(
            "centre_line", [](const PlanObject& p) { return array(p.plan.lane); },
            R"((N, 7) ndarray of float64: that of `lane`, from the car on. N is 0 if the state is "searching" or "lost",
and when the car is at rest at the end.)")
        .def_property_readonly(
            "lane", [](const PlanObject& p) { return p.plan.lane; }, "DrivableLane: the lane to drive")
        .def_property_readonly(
            "safe_m", [](const PlanObject& p) { return p.plan.safe_m; },
            "float: trusted length along `centre_line`, or the rest of it [m]")
        .def_property_readonly(
            "age_s", [](const PlanObject& p) { return p.plan.age_s; },
            "float: age of the frame that the lane is from [s]; 0 if following")
        .def_property_readonly(
            "lap", [](const PlanObject& p) { return p.plan.lap; },
            "int: number of start lines crossed since the start; in skidpad, of completed circles")
        .def_property_readonly(
            "stop", [](const PlanObject& p) { return p.plan.stop; },
            "bool: come to rest within the rest of `centre_line`")
        .def_property_readonly(
            "phase", [](const PlanObject& p) { return p.plan.phase; },
            R"(str: of skidpad "approach", "right 1", "right 2", "left 1", "left 2" or "exit"; else empty)")
        .def_property_readonly(
            "answer", [](const PlanObject& p) { return p.plan.answer; },
            "Answer: of the detector in this frame")
        .def_property_readonly(
            "latency_ms", [](const PlanObject& p) { return p.latency_ms; },
            "float: wall clock of the update [ms]")
        .def("__repr__", [](const PlanObject& p) {
            return fmt::format("<conelane.Plan {}: {:.1f} m>", to_string(p.plan.state), p.plan.lane.length_m);
        });
}

}  // namespace

void add_planner(py::module_& module) {
    add_answer(module);
    add_plan(module);
    py::class_<PlannerObject>(
        module, "Planner",
        R"(Planner(mission="trackdrive", detector="front-warm", laps=None, *, max_age_s=1.0, step_m=0.5, smoothing_m=1.75, max_gap_m=5.5, default_width_m=3.5, **options)

The path to drive in each frame of an event, from the start line to the stop.

Parameters
----------
mission : str
    "trackdrive", "autocross", "acceleration" or "skidpad".
detector : str
    One of `methods()`.
laps : int, optional
    Of trackdrive, by default 10, and of autocross, by default 1. The other missions have none.
max_age_s : float
    Largest age of a lane that is still driven [s].
step_m, smoothing_m, max_gap_m, default_width_m : float
    Of the lanes in plans, see `Lane.drivable`.
nearest, parameters, pairing, weights : optional
    Options of the detector, see `Detector`.

Raises
------
ValueError
    For an unknown mission, detector or option, for one that the mission or the detector does not use, and for
    values out of range.

Notes
-----
Planners are independent of each other, and the interpreter lock is free while they plan: use one for each run.
Calls of one planner from several threads wait for each other.

Examples
--------
>>> import conelane
>>> planner = conelane.Planner(mission="autocross")
>>> cones = [[x, y] for x in (2, 6, 10, 14) for y in (-1.5, 1.5)]
>>> plan = planner.update(cones, (0, 0, 0), time_s=0.0)
>>> plan.state, plan.lap, plan.stop
('following', 0, False)
>>> plan = planner.update([], (1, 0, 0), time_s=0.1)
>>> plan.state, plan.age_s
('bridging', 0.1)
>>> bool(plan.centre_line[0, 1] > 0.9)
True
)")
        .def(py::init([](const std::string& mission, const std::string& detector, std::optional<int> laps,
                         double max_age_s, double step_m, double smoothing_m, double max_gap_m,
                         double default_width_m, const py::kwargs& given) {
                 return std::make_unique<PlannerObject>(
                     PlannerOptions{mission_named(mission),
                                    detector,
                                    detector_options(detector, given),
                                    laps,
                                    {step_m, smoothing_m, max_gap_m, default_width_m},
                                    max_age_s});
             }),
             py::arg("mission") = "trackdrive", py::arg("detector") = "front-warm",
             py::arg("laps") = py::none(), py::kw_only(), py::arg("max_age_s") = PlannerOptions{}.max_age_s,
             py::arg("step_m") = DrivableOptions{}.step_m,
             py::arg("smoothing_m") = DrivableOptions{}.smoothing_m,
             py::arg("max_gap_m") = DrivableOptions{}.max_gap_m,
             py::arg("default_width_m") = DrivableOptions{}.default_width_m)
        .def(
            "update",
            [](PlannerObject& planner, const py::object& cones, const py::object& pose,
               const py::object& time_s, const py::object& ids, const py::object& colors,
               std::optional<double> time_limit_ms, const py::object& confidences,
               const py::object& covariances) {
                Frame frame{time_of(time_s), python::pose(pose),
                            python::cones(cones, ids, colors, confidences, covariances)};
                if (ids.is_none()) {
                    for (Cone& cone : frame.cones) cone.id = kNoId;
                }
                return planner.update(frame, time_limit_ms);
            },
            py::arg("cones"), py::arg("pose"), py::arg("time_s"), py::arg("ids") = py::none(),
            py::arg("colors") = py::none(), py::arg("time_limit_ms") = 20.0, py::kw_only(),
            py::arg("confidences") = py::none(), py::arg("covariances") = py::none(),
            R"(update(cones, pose, time_s, ids=None, colors=None, time_limit_ms=20.0, *, confidences=None, covariances=None)

The plan of the next frame.

Parameters
----------
cones : (N, 2) array_like of float
    Positions x, y [m] of what the car sees now, or of its map, in the frame of `pose`. N may be 0.
pose : (3,) array_like of float
    The car in a fixed map: x, y [m] and yaw [rad].
time_s : float
    Time of the frame, by any clock that never goes back [s]. A frame that is not later than the last one changes
    nothing: its plan is the last plan, with the state "bridging" if the frame is older.
ids : (N,) array_like of int, optional
    Distinct ids of the cones in the map; `NO_ID` for a cone without one. Without an id, a cone is recognised by
    its place.
colors : (N,) array_like of str or int, or (N, 5) array_like of float, optional
    As in `Detector.detect`; of probabilities the planner keeps the most probable label. Orange cones on both sides of the lane are
    the start line, big ones before others.
time_limit_ms : float or None
    Of the detector, wall clock [ms]; None for no limit.
confidences : (N,) array_like of float, optional
    Of the detections, in [0, 1]. By default 1.
covariances : (N, 2, 2) array_like of float, optional
    As of `Detector.detect`. They are checked, and the planner does not use them: it keeps means of many sightings.

Returns
-------
Plan

Raises
------
ValueError
    For wrong shapes and dtypes, numbers that are not finite, and an id that occurs twice; the planner then stays
    unchanged.
)")
        .def(
            "course",
            [](PlannerObject& planner) -> std::optional<py::array_t<double>> {
                const std::optional<DrivableLane> course = planner.course();
                if (!course) return std::nullopt;
                return array(*course);
            },
            R"(course()

The whole course, once a lap is known.

Returns
-------
(N, 7) ndarray of float64 or None
    Columns as of `Lane.centre_line`; the last row is one step before the first one. None before that, and
    in acceleration and skidpad.
)")
        .def("reset", &PlannerObject::reset, R"(reset()

Forgets the run.
)")
        .def_property_readonly(
            "mission", [](const PlannerObject& p) { return to_string(p.mission()); }, "str")
        .def_property_readonly("detector", &PlannerObject::detector, "str: its name")
        .def("__repr__", [](const PlannerObject& p) {
            return fmt::format("<conelane.Planner '{}' by '{}'>", to_string(p.mission()), p.detector());
        });
}

}  // namespace conelane::python
