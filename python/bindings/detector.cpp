#include "conelane/invalid_input.hpp"
#include "conelane/speed_profile.hpp"
#include "detectors/recipe.hpp"
#include "python/bindings/bindings.hpp"

#include <chrono>
#include <mutex>

namespace conelane::python {
namespace {

/// str or os.PathLike: a file; bytes: its content.
std::variant<std::filesystem::path, WeightsBytes> weights_of(py::handle object) {
    if (py::isinstance<py::bytes>(object)) return WeightsBytes{object.cast<std::string>()};
    try {  // a name on disk need not be UTF-8
        const py::bytes path = py::module_::import("os").attr("fsencode")(object);
        return std::filesystem::path(std::string(path));
    } catch (const py::error_already_set&) {
        throw InvalidInput("weights", "is neither the path nor the bytes of a file");
    }
}

/// The options that Python gives a detector of that name. Throws InvalidInput if the detector does not use an
/// option, and names `others` beside those that there are. make_detector reports an unknown name.
DetectorOptions detector_options(const std::string& name, const py::kwargs& given, const char* others = "") {
    const DetectorRecipe* const recipe = find_recipe(name);
    DetectorOptions options;
    for (const auto& [key_object, value] : given) {
        const std::string key = py::str(key_object);
        constexpr std::array<std::string_view, 4> kOptions{"nearest", "parameters", "pairing", "weights"};
        if (std::ranges::find(kOptions, key) == kOptions.end()) {
            throw InvalidInput("options", "there is no option '" + key + "', only " + others +
                                              "nearest, parameters, pairing, weights");
        }
        if (value.is_none()) continue;
        if (key == "nearest") {
            options.nearest = positive_count(value, "nearest");
        } else if (key == "parameters") {
            options.rld_parameters = rld_parameters(value);
        } else if (key == "pairing") {
            options.pairing = pairing_of(std::string(py::str(value)));
        } else {
            options.weights = weights_of(value);
        }
        if (recipe == nullptr || key == "nearest") continue;
        if (key == "weights") {
            if (!recipe->takes_weights())
                throw InvalidInput(key, "is of front, front-warm and rld-strip, '" + name + "' has none");
        } else if (!recipe->is_rld()) {
            throw InvalidInput(key, "is of the detectors rld-..., '" + name + "' has none");
        }
    }
    return options;
}

/// Calls of one object from several threads wait for each other; the interpreter is free meanwhile. The lock
/// of the interpreter is released first: the owner of the mutex may need it to finish.
template <typename Work>
auto alone(std::mutex& mutex, const Work& work) {
    const py::gil_scoped_release unlocked;
    const std::scoped_lock lock(mutex);
    return work();
}

/// How long the work takes [ms].
template <typename Work>
double timed_ms(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// A detector that may be called from any thread.
class DetectorObject {
  public:
    DetectorObject(const std::string& name, const py::kwargs& given) : name_(name) {
        const DetectorOptions options = detector_options(name, given);
        detector_ = make_detector(name, options);
        const DetectorRecipe* const recipe = find_recipe(name);
        description_ = recipe->description;
        nearest_ = cone_set(*recipe, options).nearest;
    }

    [[nodiscard]] LaneObject detect(std::shared_ptr<const Scene> scene, std::optional<double> time_limit_ms) {
        const DetectionLimits limits{.time_limit_ms = limit_of(time_limit_ms)};
        if (std::isnan(limits.time_limit_ms)) throw InvalidInput("time_limit_ms", "is not a number");
        LaneObject lane{{}, std::move(scene)};
        LaneRecord& record = lane.record;
        record.scene = lane.scene->id;
        record.detector = name_;
        record.nearest = nearest_;
        const auto detect = [&] { record.answer = detector_->detect(*lane.scene, limits); };
        record.latency_ms = alone(mutex_, [&] { return timed_ms(detect); });
        if (record.answer.status == LaneStatus::error)
            validate(*lane.scene);  // throws if the scene is invalid
        return lane;
    }

    void reset() {
        alone(mutex_, [this] { detector_->reset(); });
    }

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] const std::string& description() const { return description_; }

  private:
    std::string name_;
    std::string description_;
    std::optional<std::size_t> nearest_;
    std::unique_ptr<LaneDetector> detector_;
    std::mutex mutex_;
};

LaneObject detect(DetectorObject& detector, const py::object& cones, const py::object& pose,
                  const py::object& ids, const py::object& colors, const py::object& confidences,
                  std::optional<double> time_limit_ms, const py::object& covariances) {
    auto scene = std::make_shared<Scene>();
    scene->cones = python::cones(cones, ids, colors, confidences, covariances);
    scene->pose = python::pose(pose);
    return detector.detect(std::move(scene), time_limit_ms);
}

LaneObject detect_scene(DetectorObject& detector, const SceneObject& scene,
                        std::optional<double> time_limit_ms) {
    return detector.detect({scene, &required(scene, "scene")->scene}, time_limit_ms);
}

py::dict methods() {
    py::dict all;
    for (const DetectorInfo& info : detectors())
        all[py::str(std::string(info.name))] = std::string(info.description);
    return all;
}

constexpr const char* kDetector = R"(Detector(name: str, **options)

A lane detector.

name: One of `methods()`.
nearest: Number of cones that the lane may have: the nearest ones ahead of the car.
parameters: Of the detectors `rld-...` except `rld-strip`: the name of a parameter set, or a dict of the values that
    differ from `rld_parameters()`.
pairing: Of the same detectors: "near_far" or "paper".
weights: Of the detectors `front`, `front-warm` and `rld-strip`: weights of your own instead of the shipped ones. The
    path of a file that ``conelane train front`` or ``train strip`` wrote, or its content as bytes.
Raises ValueError for an unknown name or option, listing the known ones, for an option that the detector does not use, for
    values out of range, and for weights that cannot be read.

Detectors are independent of each other, and the interpreter lock is free while they search: use one for each
thread. Calls of one detector from several threads wait for each other; the wait does not count in the time
limit.

>>> import conelane
>>> detector = conelane.Detector("front")
>>> lane = detector.detect([[2, -1.5], [2, 1.5], [6, -1.5], [6, 1.5], [10, -1.5], [10, 1.5]], (0, 0, 0))
>>> lane.status
'found'
>>> lane.left, lane.right
(array([1, 3, 5]), array([0, 2, 4]))
)";

constexpr const char* kDetect =
    R"(detect(cones: ArrayLike, pose: ArrayLike, ids: Optional[ArrayLike] = None, colors: Optional[ArrayLike] = None,
       confidences: Optional[ArrayLike] = None, time_limit_ms: Optional[float] = 50.0, *,
       covariances: Optional[ArrayLike] = None) -> Lane

The lane among cones.

cones: (N, 2), positions x, y [m], in any order, in the frame of reference of `pose`: the map's or the car's.
pose: (3,), the car: x, y [m] and yaw [rad], counter-clockwise, 0 along +x. In the car's frame of reference (x ahead, y
    to the left) it is (0, 0, 0).
ids: (N,), distinct ids of the cones. Detectors that remember their last lane (`...-warm`) recognise a cone by its id.
    By default the index.
colors: (N,), "unknown", "blue", "yellow", "orange", "big_orange", or their codes 0 to 4 (`Color`). Or probabilities
    of unknown, blue, yellow, small orange and big orange, (N, 5), which add up to 1 for each cone: `front` and the
    parameter `w_color` use them, other detectors the most probable label. By default unknown.
confidences: (N,), of the detections, in [0, 1]. By default 1.
time_limit_ms: Wall clock [ms]; None for no limit.
covariances: (N, 2, 2), of the positions [m^2], in the frame of reference of `pose`: symmetric and positive semidefinite.
    `front` uses them. By default unknown, with the same answers as 0.
Raises ValueError for wrong shapes and dtypes, numbers that are not finite or out of range, an invalid covariance, and an
    id that occurs twice.

>>> import conelane
>>> conelane.Detector("clc").detect([[0.0, float("nan")]], (0, 0, 0))
Traceback (most recent call last):
    ...
ValueError: cones[0].y: must be a finite number
)";

constexpr const char* kDetectScene =
    R"(detect_scene(scene: Scene, time_limit_ms: Optional[float] = 50.0) -> Lane

The same for a `Scene`. The lane has the scene's id.
)";

constexpr const char* kMethods = R"(methods() -> Dict[str, str]

The detectors of the library, by name, with their descriptions. The first one is for driving.

>>> import conelane
>>> "clc" in conelane.methods()
True
)";

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

constexpr const char* kSpeedProfile =
    R"(speed_profile(centre_line: ArrayLike, v_now: float = 0.0, stop_at_m: Optional[float] = None, *,
       a_lateral: float = 9.0, a_brake: float = 6.0, a_drive: float = 6.0, v_max: float = 20.0) -> NDArray[float64]

The fastest speeds along an open path: a limit by curvature, a pass forward for driving and a pass backward for
braking; across and along, the tyres share their grip (the friction ellipse).

centre_line: (N, 7), columns as in `Lane.centre_line`, for example of a plan.
v_now: Speed at the first point [m/s]. If the first speed of the result is lower, the car has to brake at once.
stop_at_m: Where the car has to be at rest, along the path [m], for example `Plan.safe_m`; None for nowhere.
a_lateral, a_brake, a_drive, v_max: Limits across the car, along it by the tyres and by the motor [m/s^2]; speed [m/s].
Returns (N, 4): s [m], speed [m/s], acceleration up to the next row [m/s^2], time [s]; the time past a stop is inf.
Raises ValueError for wrong shapes, and for a limit that is not positive and finite.

>>> import conelane, numpy
>>> line = numpy.zeros((21, 7))
>>> line[:, 0] = numpy.arange(21)
>>> profile = conelane.speed_profile(line, v_now=6.0, stop_at_m=20.0)
>>> float(profile[0, 1]), float(profile[20, 1])
(6.0, 0.0)
)";

py::array_t<double> speeds(const py::object& centre_line, double v_now, std::optional<double> stop_at_m,
                           double a_lateral, double a_brake, double a_drive, double v_max) {
    const Numbers rows = numbers(centre_line, "centre_line");
    if (rows.ndim() != 2 || rows.shape(1) != 7) throw InvalidInput("centre_line", "must have 7 columns");
    DrivableLane path;
    for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
        path.points.push_back({.s_m = rows.at(i, 0), .curvature_1pm = rows.at(i, 4)});
        if (!std::isfinite(rows.at(i, 0) + rows.at(i, 4)))
            throw InvalidInput("centre_line", "must be finite numbers");
        if (i > 0 && !(rows.at(i, 0) > rows.at(i - 1, 0)))
            throw InvalidInput("centre_line", "its first column must increase");
    }
    const std::vector<SpeedPoint> profile =
        speed_profile(path, {a_lateral, a_brake, a_drive, v_max}, {v_now, limit_of(stop_at_m)});
    py::array_t<double> result({rows.shape(0), py::ssize_t{4}});
    for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
        const auto& [s_m, v_mps, a_mps2, t_s] = profile[static_cast<std::size_t>(i)];
        std::ranges::copy(std::array{s_m, v_mps, a_mps2, t_s}, result.mutable_data(i));
    }
    return result;
}

constexpr const char* kPlanner =
    R"(Planner(mission: str = "trackdrive", detector: str = "front-warm", laps: Optional[int] = None, *,
        max_age_s: float = 1.0, step_m: float = 0.5, smoothing_m: float = 1.75, max_gap_m: float = 5.5,
        default_width_m: float = 3.5, **options)

The path to drive in each frame of an event, from the start line to the stop.

mission: "trackdrive", "autocross", "acceleration" or "skidpad".
detector: One of `methods()`.
laps: Of trackdrive, by default 10, and of autocross, by default 1. The other missions have none.
max_age_s: Largest age of a lane that is still driven [s].
step_m, smoothing_m, max_gap_m, default_width_m: Of the lanes in plans, see `Lane.drivable`; step_m is at most 5.
nearest, parameters, pairing, weights: Options of the detector, see `Detector`.
Raises ValueError for an unknown mission, detector or option, for an option that the mission or the detector does not use,
    and for values out of range.

Planners are independent of each other, and the interpreter lock is free while they plan: use one for each run.
Calls of one planner from several threads wait for each other.

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
    R"(update(cones: ArrayLike, pose: ArrayLike, time_s: float, ids: Optional[ArrayLike] = None,
       colors: Optional[ArrayLike] = None, time_limit_ms: Optional[float] = 20.0, *,
       confidences: Optional[ArrayLike] = None, covariances: Optional[ArrayLike] = None) -> Plan

The plan of the next frame.

cones: (N, 2), positions x, y [m] of what the car sees now, or of its map, in the frame of reference of `pose`. N may be 0.
pose: (3,), the car in a fixed map: x, y [m] and yaw [rad].
time_s: Time of the frame, by any clock that never goes back [s]. A frame that is not later than the last one changes
    nothing: it returns the last plan. Unless the two frames are equal, "following" then becomes "bridging", and
    `safe_m` is less by the distance between the two poses.
ids: (N,), distinct ids of the cones in the map; `NO_ID` for a cone without one. Without an id, a cone is recognised
    by its place.
colors: As in `Detector.detect`; of probabilities the planner keeps the most probable label. Orange cones on both
    sides of the lane are the start line, preferably big ones.
time_limit_ms: Of the detector and of the search for the place of a known course, wall clock [ms]; None for no limit.
confidences: (N,), of the detections, in [0, 1]. By default 1.
covariances: (N, 2, 2), as in `Detector.detect`. In trackdrive and autocross they are only checked: the planner keeps
    means of many sightings.
Raises ValueError as `Detector.detect`, and for a `time_s` that is not finite; the planner then stays unchanged.
)";

constexpr const char* kCourse = R"(course() -> Optional[NDArray[float64]]

The whole course, while a lap is known.
Returns (N, 7), columns as in `Lane.centre_line`; the last row is one step before the first one. None while no lap is
    known, and in acceleration and skidpad. After more than 6 m driven without a lane, no lap is known until another
    one is complete.
)";

void add_plan(py::module_& module) {
    Class<PlanObject>(module, "Plan", "The path to drive. Every attribute is a copy.")
        .get(
            "state",
            R"(str: "searching": no lane has been found yet; "following": the lane is of this frame, or of a known
course, which this frame confirms; "bridging": this frame gives no lane to
follow, so the rest of an earlier one; "lost": no earlier lane is left, so there is no path: brake; "finished": the
last line is crossed, and the lane is the stretch on which to come to rest.)",
            &PlanObject::state, kName)
        .get(
            "centre_line",
            R"(NDArray[float64]: (N, 7), that of `lane`, from the car on. N is 0 if the state is "searching" or "lost", and once the
stretch to come to rest on is driven.)",
            &PlanObject::lane, kArray)
        .get("lane", "DrivableLane: the lane to drive", &Plan::lane)
        .get("safe_m", "float: length of `centre_line` that is trusted [m]", &Plan::safe_m)
        .get("age_s", "float: age of the frame that the lane is from [s]; 0 if following", &Plan::age_s)
        .get("lap", "int: number of laps driven; in skidpad of completed circles, in acceleration 0",
             &Plan::lap)
        .get("stop", "bool: the last line is crossed: come to rest on `centre_line`", &Plan::stop)
        .get(
            "stop_line_m",
            R"(Optional[float]: distance along `centre_line` to the line past which the car has to stop [m]; None while that
line is not on the lane, not known, or crossed)",
            &Plan::stop_line_m)
        .get(
            "reason",
            R"(str: why the course is not trusted to its end, the path is lost or the frame not later; else empty)",
            &Plan::reason)
        .get("phase",
             R"(str: of skidpad "approach", "right 1", "right 2", "left 1", "left 2" or "exit"; else empty)",
             &Plan::phase)
        .get("answer", "Answer: of the detector to this frame; stopped if it did not run", &Plan::answer)
        .get("latency_ms", "float: wall clock of the update [ms]", &PlanObject::latency_ms)
        .repr([](const PlanObject& p) {
            return py::str("<conelane.Plan {}: {:.1f} m>").format(to_string(p.state), p.lane.length_m);
        });
}

void add_planner(py::module_& module) {
    add_plan(module);
    Class<PlannerObject>(module, "Planner", kPlanner)
        .init([](const std::string& mission, const std::string& detector, std::optional<int> laps,
                 double max_age_s, double step_m, double smoothing_m, double max_gap_m,
                 double default_width_m, const py::kwargs& given) {
            constexpr const char* kOthers =
                "mission, detector, laps, max_age_s, step_m, smoothing_m, max_gap_m, default_width_m, ";
            return std::make_unique<PlannerObject>(PlannerOptions{
                mission_named(mission), detector, detector_options(detector, given, kOthers), laps,
                DrivableOptions{step_m, smoothing_m, max_gap_m, default_width_m}, max_age_s});
        })
        .method(kUpdate, update)
        .method(kCourse, course)
        .method("reset() -> None\n\nForgets the run.\n", &PlannerObject::reset)
        .get("mission", "str: its name", &PlannerObject::mission, kName)
        .get("detector", "str: its name", &PlannerObject::detector)
        .repr([](const PlannerObject& p) {
            return py::str("<conelane.Planner '{}' by '{}'>").format(to_string(p.mission()), p.detector());
        });
}

}  // namespace

void add_detector(py::module_& module) {
    Class<DetectorObject>(module, "Detector", kDetector)
        .init([](const std::string& name, const py::kwargs& given) {
            return std::make_unique<DetectorObject>(name, given);
        })
        .method(kDetect, detect)
        .method(kDetectScene, detect_scene)
        .method("reset() -> None\n\nForgets earlier calls: for a new lap or another place.\n",
                &DetectorObject::reset)
        .get("name", "str: one of `methods()`", &DetectorObject::name)
        .get("meaning", "str: description in one line", &DetectorObject::description)
        .repr([](const DetectorObject& detector) { return "<conelane.Detector '" + detector.name() + "'>"; });
    add_function(module, kMethods, methods);
    add_function(module, kSpeedProfile, speeds);
    add_planner(module);
}

}  // namespace conelane::python
