#include "conelane/planner.hpp"

#include "conelane/invalid_input.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <pybind11/stl.h>

namespace conelane::python {
namespace {

struct PlanObject : Plan {
    double latency_ms = 0.0;
};

/// A planner that may be called from any thread.
class PlannerObject {
  public:
    explicit PlannerObject(const PlannerOptions& options)
        : mission_(options.mission), detector_(options.detector), planner_(make_planner(options)) {}

    [[nodiscard]] PlanObject update(const Frame& frame, std::optional<double> time_limit_ms) {
        PlanObject plan;
        plan.latency_ms = alone(mutex_, [&] {
            return timed_ms([&] {
                static_cast<Plan&>(plan) =
                    planner_->update(frame, {.time_limit_ms = limit_of(time_limit_ms)});
            });
        });
        return plan;
    }

    [[nodiscard]] std::optional<DrivableLane> course() {
        return alone(mutex_, [this] { return planner_->course(); });
    }

    void reset() {
        alone(mutex_, [this] { planner_->reset(); });
    }

    [[nodiscard]] Mission mission() const { return mission_; }
    [[nodiscard]] const std::string& detector() const { return detector_; }

  private:
    Mission mission_;
    std::string detector_;
    std::unique_ptr<Planner> planner_;
    std::mutex mutex_;
};

PlanObject update(PlannerObject& planner, const py::object& cones, const py::object& pose,
                  const py::object& time_s, const py::object& ids, const py::object& colors,
                  std::optional<double> time_limit_ms, const py::object& confidences,
                  const py::object& covariances) {
    Frame frame{number(time_s, "time_s"), python::pose(pose),
                python::cones(cones, ids, colors, confidences, covariances)};
    if (ids.is_none()) {
        for (Cone& cone : frame.cones) cone.id = kNoId;
    }
    return planner.update(frame, time_limit_ms);
}

std::optional<py::array_t<double>> course(PlannerObject& planner) {
    const std::optional<DrivableLane> course = planner.course();
    if (!course) return std::nullopt;
    return array(*course);
}

constexpr const char* kPlanner =
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
)";

constexpr const char* kUpdate =
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
)";

constexpr const char* kCourse = R"(course()

The whole course, once a lap is known.

Returns
-------
(N, 7) ndarray of float64 or None
    Columns as of `Lane.centre_line`; the last row is one step before the first one. None before that, and
    in acceleration and skidpad.
)";

void add_plan(py::module_& module) {
    Class<PlanObject>(module, "Plan", "The path to drive. Every attribute is a copy.")
        .get(
            "state",
            R"(str: "searching": no lane has been found yet; "following": the lane is of this frame; "bridging": no lane in
this frame, so the rest of an earlier one; "lost": no earlier lane is left, so there is no path: brake;
"finished": the last line is crossed, and the lane is the stretch on which to come to rest.)",
            &PlanObject::state, kName)
        .get(
            "centre_line",
            R"((N, 7) ndarray of float64: that of `lane`, from the car on. N is 0 if the state is "searching" or "lost",
and when the car is at rest at the end.)",
            &PlanObject::lane, kArray)
        .get("lane", "DrivableLane: the lane to drive", &Plan::lane)
        .get("safe_m", "float: trusted length along `centre_line`, or the rest of it [m]", &Plan::safe_m)
        .get("age_s", "float: age of the frame that the lane is from [s]; 0 if following", &Plan::age_s)
        .get("lap", "int: number of start lines crossed since the start; in skidpad, of completed circles",
             &Plan::lap)
        .get("stop", "bool: come to rest within the rest of `centre_line`", &Plan::stop)
        .get("phase",
             R"(str: of skidpad "approach", "right 1", "right 2", "left 1", "left 2" or "exit"; else empty)",
             &Plan::phase)
        .get("answer", "Answer: of the detector in this frame", &Plan::answer)
        .get("latency_ms", "float: wall clock of the update [ms]", &PlanObject::latency_ms)
        .repr([](const PlanObject& p) {
            return fmt::format("<conelane.Plan {}: {:.1f} m>", to_string(p.state), p.lane.length_m);
        });
}

}  // namespace

void add_planner(py::module_& module) {
    add_plan(module);
    Class<PlannerObject>(module, "Planner", kPlanner)
        .init([](const std::string& mission, const std::string& detector, std::optional<int> laps,
                 double max_age_s, double step_m, double smoothing_m, double max_gap_m,
                 double default_width_m, const py::kwargs& given) {
            return std::make_unique<PlannerObject>(
                PlannerOptions{mission_named(mission),
                               detector,
                               detector_options(detector, given),
                               laps,
                               {step_m, smoothing_m, max_gap_m, default_width_m},
                               max_age_s});
        })
        .method(kUpdate, update)
        .method(kCourse, course)
        .method("reset()\n\nForgets the run.\n", &PlannerObject::reset)
        .get("mission", "str: its name", &PlannerObject::mission, kName)
        .get("detector", "str: its name", &PlannerObject::detector)
        .repr([](const PlannerObject& p) {
            return fmt::format("<conelane.Planner '{}' by '{}'>", to_string(p.mission()), p.detector());
        });
}

}  // namespace conelane::python
