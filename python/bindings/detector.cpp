#include "conelane/detectors.hpp"
#include "conelane/invalid_input.hpp"
#include "detectors/recipe.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"

#include <cmath>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include <pybind11/stl.h>

namespace conelane::python {
namespace {

/// str or os.PathLike: a file; bytes: its content.
std::variant<std::filesystem::path, WeightsBytes> weights_of(py::handle object) {
    if (py::isinstance<py::bytes>(object)) return WeightsBytes{object.cast<std::string>()};
    PyObject* const path = PyOS_FSPath(object.ptr());
    if (path == nullptr) {
        PyErr_Clear();
        throw InvalidInput("weights", "is neither the path nor the bytes of a file");
    }
    const auto text = py::reinterpret_steal<py::object>(path);
    return std::filesystem::path(text.cast<std::string>());
}

}  // namespace

DetectorOptions detector_options(const std::string& name, const py::kwargs& given) {
    const DetectorRecipe* const recipe = find_recipe(name);
    DetectorOptions options;
    for (const auto& [key_object, value] : given) {
        const std::string key = py::str(key_object);
        if (value.is_none()) continue;
        if (key == "nearest") {
            options.nearest = positive_count(value, "nearest");
        } else if (key == "parameters") {
            options.rld_parameters = rld_parameters(value);
        } else if (key == "pairing") {
            options.pairing = pairing_of(std::string(py::str(value)));
        } else if (key == "weights") {
            options.weights = weights_of(value);
        } else {
            throw InvalidInput(
                "options", "there is no option '" + key + "', only nearest, parameters, pairing, weights");
        }
        if (recipe == nullptr || key == "nearest") continue;
        if (key == "weights") {
            if (!recipe->takes_weights())
                throw InvalidInput(key, "is of the detectors front and front-warm, '" + name + "' has none");
        } else if (!recipe->is_rld()) {
            throw InvalidInput(key, "is of the detectors rld-..., '" + name + "' has none");
        }
    }
    return options;
}

namespace {

/// A detector that may be called from any thread: calls of one instance wait for each other.
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
    return detector.detect({scene, &scene->scene}, time_limit_ms);
}

py::dict methods() {
    py::dict all;
    for (const DetectorInfo& info : detectors())
        all[py::str(std::string(info.name))] = std::string(info.description);
    return all;
}

constexpr const char* kDetector = R"(Detector(name, **options)

A lane detector.

Parameters
----------
name : str
    One of `methods()`.
nearest : int, optional
    Number of cones that it uses: the nearest ones ahead of the car.
parameters : str or dict, optional
    Of the detectors `rld-...`: the name of a parameter set, or a dict of the values that differ from the
    defaults; see `rld_parameters`.
pairing : str, optional
    Of the detectors `rld-...`: "near_far" or "paper".
weights : str, os.PathLike or bytes, optional
    Of the detectors `front` and `front-warm`: weights of your own instead of the shipped ones. The path of a file
    that ``conelane train front --out FILE`` wrote, or its content as bytes.

Raises
------
ValueError
    For an unknown name or option, listing the known ones, for an option that the detector does not use, for
    values out of range, and for weights that cannot be read.

Notes
-----
Detectors are independent of each other, and the interpreter lock is free while they search: use one for each
thread. Calls of one detector from several threads wait for each other; the wait does not count in the time
limit.

Examples
--------
>>> import conelane
>>> detector = conelane.Detector("front")
>>> lane = detector.detect([[2, -1.5], [2, 1.5], [6, -1.5], [6, 1.5], [10, -1.5], [10, 1.5]], (0, 0, 0))
>>> lane.status
'found'
>>> lane.left, lane.right
(array([1, 3, 5]), array([0, 2, 4]))
)";

constexpr const char* kDetect =
    R"(detect(cones, pose, ids=None, colors=None, confidences=None, time_limit_ms=50.0, *, covariances=None)

The lane among cones.

Parameters
----------
cones : (N, 2) array_like of float
    Positions x, y [m], in any order, in the frame of `pose`: a map, or the car.
pose : (3,) array_like of float
    The car: x, y [m] and yaw [rad], counter-clockwise, 0 along +x. In a frame of the car with x ahead and y
    to the left it is (0, 0, 0).
ids : (N,) array_like of int, optional
    Distinct ids of the cones. Detectors that remember their last lane (`...-warm`) recognise a cone by its
    id. By default the index.
colors : (N,) array_like of str or int, or (N, 5) array_like of float, optional
    "unknown", "blue", "yellow", "orange", "big_orange", or their codes 0 to 4 (`Color`). Or probabilities of unknown, blue,
    yellow, small orange and big orange, which add up to 1 for each cone: `front` uses them, other detectors
    the most probable label. By default unknown.
confidences : (N,) array_like of float, optional
    Of the detections, in [0, 1]. By default 1.
time_limit_ms : float or None
    Wall clock [ms]; None for no limit.
covariances : (N, 2, 2) array_like of float, optional
    Of the positions [m^2], in the frame of `pose`: symmetric and positive semidefinite. `front` uses them. By
    default unknown, which is the same as 0.

Returns
-------
Lane

Raises
------
ValueError
    For wrong shapes and dtypes, numbers that are not finite, an invalid covariance, and an id that occurs twice.

Examples
--------
>>> import conelane
>>> conelane.Detector("clc").detect([[0.0, float("nan")]], (0, 0, 0))
Traceback (most recent call last):
    ...
ValueError: cones[0].y: must be a finite number
)";

constexpr const char* kDetectScene = R"(detect_scene(scene, time_limit_ms=50.0)

The same for a `Scene`. The lane has the scene's id.

Returns
-------
Lane
)";

constexpr const char* kMethods = R"(methods()

The detectors of the library, by name, with their descriptions. The first one is for driving.

Returns
-------
dict of str to str

Examples
--------
>>> import conelane
>>> "clc" in conelane.methods()
True
)";

}  // namespace

void add_detector(py::module_& module) {
    Class<DetectorObject>(module, "Detector", kDetector)
        .init([](const std::string& name, const py::kwargs& given) {
            return std::make_unique<DetectorObject>(name, given);
        })
        .method(kDetect, detect)
        .method(kDetectScene, detect_scene)
        .method("reset()\n\nForgets earlier calls: for a new lap or another place.\n", &DetectorObject::reset)
        .get("name", "str: as `methods` has it", &DetectorObject::name)
        .get("meaning", "str: one line", &DetectorObject::description)
        .repr([](const DetectorObject& detector) { return "<conelane.Detector '" + detector.name() + "'>"; });
    add_function(module, kMethods, methods);
}

}  // namespace conelane::python
