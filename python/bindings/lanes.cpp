#include "conelane/invalid_input.hpp"
#include "python/bindings/bindings.hpp"

#include <utility>

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

/// A number of the detector's proof, if it has one.
template <typename Value>
std::optional<double> of_proof(const LaneObject& lane, Value value) {
    if (!lane.record.answer.optimality) return std::nullopt;
    return (*lane.record.answer.optimality).*value;
}

py::dict merged(const LaneObject& lane) {
    py::dict merged;
    for (const auto& [cone, into] : lane.record.answer.merged) merged[py::int_(cone)] = into;
    return merged;
}

py::array_t<double> centre_line(const LaneObject& lane, double step_m, double smoothing_m,
                                double usual_width_m) {
    try {
        return array(
            drivable(lane, {.step_m = step_m, .smoothing_m = smoothing_m, .default_width_m = usual_width_m}));
    } catch (const InvalidInput& error) {
        if (error.key() != "default_width_m") throw;
        throw InvalidInput("usual_width_m", std::string(error.what()).substr(error.key().size() + 2));
    }
}

py::str text_of(const LaneObject& lane) {
    const LaneRecord& record = lane.record;
    return py::str("<conelane.Lane {}: {} left, {} right of {} cones>")
        .format(to_string(record.answer.status),
                record.points ? record.points->left.size() : record.answer.lane.left.size(),
                record.points ? record.points->right.size() : record.answer.lane.right.size(),
                lane.scene->cones.size());
}

static_assert(DrivableOptions{}.step_m == 0.5 && DrivableOptions{}.smoothing_m == 1.75 &&
                  DrivableOptions{}.max_gap_m == 5.5 && DrivableOptions{}.default_width_m == 3.5,
              "the docstrings have the defaults");

constexpr const char* kCentreLine =
    R"(centre_line(step_m: float = 0.5, *, smoothing_m: float = 1.75, usual_width_m: float = 3.5) -> NDArray[float64]

The middle of the lane from the car on.

step_m: Arc length from point to point [m], in [0.01, 100].
smoothing_m: Length scale of the smoothing [m], in [0.25, 5].
usual_width_m: Width of a lane of which only one boundary was found [m], in [1, 6.5].
Returns (M, 7), columns: s, the arc length from the car's foot point [m]; x, y [m]; heading [rad], in (-pi, pi];
    curvature [1/m], positive in a left bend; distance to the left and to the right boundary [m]. M is 0 if there is
    no lane that can be driven.

>>> import conelane
>>> cones = [[0, -1.5], [0, 1.5], [4, -1.5], [4, 1.5], [8, -1.5], [8, 1.5]]
>>> line = conelane.Detector("front").detect(cones, (0, 0, 0)).centre_line(step_m=2)
>>> line.shape
(5, 7)
>>> line[:, 0].tolist()
[0.0, 2.0, 4.0, 6.0, 8.0]
)";

constexpr const char* kDrivable =
    R"(drivable(step_m: float = 0.5, *, smoothing_m: float = 1.75, max_gap_m: float = 5.5,
         default_width_m: float = 3.5) -> DrivableLane

The centre line with the gaps that it bridges and whether a boundary was inferred.

step_m, smoothing_m: As in `centre_line`.
max_gap_m: Longer gaps of a boundary are reported as bridged [m].
default_width_m: The `usual_width_m` of `centre_line`.
)";

constexpr const char* kPlot = R"(plot(ax: Optional[Axes] = None) -> Axes

Draws cones, both boundaries, the centre line and the car. Needs matplotlib.

ax: By default those of the current figure.
)";

/// What a lane and the answer in a plan say; `steps` lead to the detector's answer.
template <typename Object, typename... Steps>
void add_answer(Class<Object>& object, Steps... steps) {
    object
        .get(
            "status",
            R"(str: "found"; "none": there is no lane, by proof or complete search; "stopped": no lane that can be driven was found,
see `stopped_by` and `message`; "error": see `message`.)",
            steps..., &LaneAnswer::status, kName)
        .get("found", "bool: whether the status is \"found\"", steps..., &LaneAnswer::status,
             [](LaneStatus status) { return status == LaneStatus::found; })
        .get("message", "str: of an error; why a found lane cannot be driven; that another d_near was used",
             steps..., &LaneAnswer::message)
        .get(
            "stopped_by",
            R"(Optional[str]: the limit: "time", "memory" or "iterations", also of a beam that left lanes out)",
            steps..., &LaneAnswer::stopped_by, kName)
        .get("confidence",
             "Optional[float]: probability that the lane is usable; None if the detector has none", steps...,
             &LaneAnswer::confidence)
        .get(
            "trusted_m",
            R"(Optional[float]: trusted length [m]. A lane found by `Detector` always has one: with a `confidence` it follows from
probabilities, without one from a rule, 10 m at most. None if no lane was found, or if a file does not have it: do not
trust that lane.)",
            steps..., &LaneAnswer::trusted_m);
}

void add_boundaries(Class<LaneObject>& lane) {
    lane.get(
            "left",
            R"(NDArray[int64]: (L,), the cones of the left boundary from the car outward, as indices into `cones`; empty if no lane,
or only the right boundary, was found.)",
            [](const LaneObject& l) { return boundary_indices(l, true); })
        .get("right", "NDArray[int64]: (R,), the same for the right boundary",
             [](const LaneObject& l) { return boundary_indices(l, false); })
        .get("left_points", "NDArray[float64]: (L, 2), the left boundary's positions [m]",
             [](const LaneObject& l) { return array(boundary(l, true)); })
        .get("right_points", "NDArray[float64]: (R, 2), the right boundary's positions [m]",
             [](const LaneObject& l) { return array(boundary(l, false)); })
        .get("closed",
             "bool: a whole circuit, in which each boundary returns from its last cone to its first",
             [](const LaneObject& l) { return l.record.answer.lane.closed; })
        .method(kCentreLine, centre_line)
        .method(kDrivable,
                [](const LaneObject& l, double step_m, double smoothing_m, double max_gap_m,
                   double default_width_m) {
                    return drivable(l, {step_m, smoothing_m, max_gap_m, default_width_m});
                })
        .method(kPlot,
                [](const py::object& self, const py::object& ax) {
                    return py::module_::import("conelane._plot").attr("plot_lane")(self, ax);
                })
        .repr(text_of);
}

void add_record(Class<LaneObject>& lane) {
    lane.cones(&LaneObject::scene, &Scene::cones)
        .get("pose", "NDArray[float64]: (3,), x, y [m] and yaw [rad] of the car", &LaneObject::scene,
             &Scene::pose, kArray)
        .get(
            "merged",
            R"(Dict[int, int]: from the id of each cone that the detector left out, because another cone is within 0.12 m (front,
front-warm: 0.35 m if there are many), to that cone's id; empty for a lane from a file)",
            merged)
        .get("objective", "Optional[float]: cost of the lane, of a detector that states one",
             [](const LaneObject& l) { return of_proof(l, &Optimality::objective); })
        .get("bound", "Optional[float]: proven lower bound of the objective",
             [](const LaneObject& l) { return of_proof(l, &Optimality::bound); })
        .get("latency_ms", "float: wall clock of the search [ms]", &LaneObject::record,
             &LaneRecord::latency_ms)
        .get("method", "str: name of the detector", &LaneObject::record, &LaneRecord::detector)
        .get("scene_id", "str: id of the scene that it answers; empty for arrays", &LaneObject::record,
             &LaneRecord::scene);
}

void add_answer_of_plan(py::module_& module) {
    Class<LaneAnswer> answer(module, "Answer", "The detector's answer to a frame.");
    add_answer(answer);
    answer
        .get(
            "left_ids",
            R"(NDArray[int64]: (L,), cones of the left boundary from the car outward, by the ids of the frames; a cone without an id
has one from the planner, negative in trackdrive and autocross)",
            &LaneAnswer::lane, &Lane::left, kArray)
        .get("right_ids", "NDArray[int64]: (R,), the same for the right boundary", &LaneAnswer::lane,
             &Lane::right, kArray)
        .repr([](const LaneAnswer& a) {
            return py::str("<conelane.Answer {}: {} left, {} right>")
                .format(to_string(a.status), a.lane.left.size(), a.lane.right.size());
        });
}

void add_drivable_lane(py::module_& module) {
    Class<DrivableLane>(module, "DrivableLane", "A lane ready to be driven. Every attribute is a copy.")
        .get("centre_line", "NDArray[float64]: (N, 7), columns as in `Lane.centre_line`",
             [](const DrivableLane& d) { return array(d); })
        .get("closed", "bool: a circuit: the last row is one step before the first", &DrivableLane::closed)
        .get("length_m", "float: of the centre line [m]", &DrivableLane::length_m)
        .get("trusted_m", "Optional[float]: arc length up to which the detector trusts the lane [m]",
             &DrivableLane::trusted_m)
        .get(
            "bridged",
            R"(List[Tuple[str, float, float]]: gaps between successive cones longer than `max_gap_m`, in which a cone is missing or
was not seen: "left" or "right", and the arc lengths beside the two cones [m])",
            [](const DrivableLane& d) {
                py::list gaps;
                for (const BridgedGap& gap : d.bridged)
                    gaps.append(py::make_tuple(gap.on_left ? "left" : "right", gap.from_s_m, gap.to_s_m));
                return gaps;
            })
        .get("left_inferred",
             "bool: no cone of the left boundary is known, it is assumed at `default_width_m`",
             &DrivableLane::left_inferred)
        .get("right_inferred", "bool: the same for the right boundary", &DrivableLane::right_inferred);
}

}  // namespace

void add_lanes(py::module_& module) {
    add_drivable_lane(module);
    Class<LaneObject> lane(module, "Lane", "The answer of a detector. Every attribute is a copy.");
    add_boundaries(lane);
    add_answer(lane, &LaneObject::record, &LaneRecord::answer);
    add_record(lane);
    add_answer_of_plan(module);
}

}  // namespace conelane::python
