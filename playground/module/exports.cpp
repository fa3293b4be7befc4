// The functions that a host calls; most programs use conelane.mjs beside this file instead. Input is numbers
// and texts that the host writes to `conelane_room`; the answer is the JSON text `conelane_text`. Invalid
// input is thrown, see runtime.cpp.
#include "conelane/check.hpp"
#include "conelane/core_solvers.hpp"
#include "conelane/detectors.hpp"
#include "conelane/invalid_input.hpp"
#include "conelane/planner.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/world/centre_line.hpp"
#include "evaluation/world/generated_tracks.hpp"
#include "model/deadline.hpp"
#include "playground/module/json_text.hpp"

#define CONELANE_EXPORT(name) extern "C" __attribute__((export_name(#name)))

namespace conelane::playground {
namespace {

std::vector<double> room;
JsonText out;
std::map<std::string, std::unique_ptr<LaneDetector>, std::less<>> kept_detectors;
std::unique_ptr<Planner> planner;

/// A scene is x, y, yaw and kConeNumbers for each cone: id, x, y, color as in ConeColor, confidence.
constexpr std::size_t kPoseNumbers = 3;
constexpr std::size_t kConeNumbers = 5;
/// Ids are whole numbers that a double holds exactly.
constexpr double kMaxId = 9007199254740991.0;

Scene read_scene(std::span<const double> numbers) {
    Scene scene{.id = "scene", .pose = {{numbers[0], numbers[1]}, numbers[2]}, .cones = {}};
    for (std::size_t at = kPoseNumbers; at + kConeNumbers <= numbers.size(); at += kConeNumbers) {
        const double id = numbers[at];
        const bool has_id = !std::isnan(id);
        if (has_id && !(std::abs(id) <= kMaxId && id == std::trunc(id))) {
            throw InvalidInput("cones[" + std::to_string(scene.cones.size()) + "].id",
                               "must be a whole number");
        }
        scene.cones.push_back({.id = has_id ? static_cast<ConeId>(id) : kNoId,
                               .position = {numbers[at + 1], numbers[at + 2]},
                               .color = static_cast<ConeColor>(static_cast<int>(numbers[at + 3])),
                               .confidence = numbers[at + 4]});
    }
    return scene;
}

/// All numbers of the parameters, in the order of rld_parameter_fields and rld_extra_fields.
std::vector<RldParameterField> parameter_fields() {
    std::vector<RldParameterField> fields(rld_parameter_fields().begin(), rld_parameter_fields().end());
    fields.insert(fields.end(), rld_extra_fields().begin(), rld_extra_fields().end());
    return fields;
}

/// NaN is the default.
RldParameters read_parameters(std::span<const double> numbers) {
    RldParameters parameters;
    const std::vector<RldParameterField> fields = parameter_fields();
    for (std::size_t i = 0; i < std::min(numbers.size(), fields.size()); ++i) {
        if (!std::isnan(numbers[i])) parameters.*fields[i].value = numbers[i];
    }
    validate(parameters);
    return parameters;
}

std::size_t index_of(const Scene& scene, double id) {
    const auto cone = std::ranges::find(scene.cones, static_cast<ConeId>(id), &Cone::id);
    if (cone == scene.cones.end()) {
        throw InvalidInput("edges", "the scene has no cone " + std::to_string(static_cast<ConeId>(id)));
    }
    return static_cast<std::size_t>(cone - scene.cones.begin());
}

LaneGraph read_edges(const Scene& scene, std::span<const double> ids) {
    LaneGraph graph;
    for (std::size_t at = 0; at + 1 < ids.size(); at += 2) {
        const std::size_t a = index_of(scene, ids[at]);
        const std::size_t b = index_of(scene, ids[at + 1]);
        if (a == b) throw InvalidInput("edges", "an edge joins two cones");
        graph.edges.push_back(make_edge(a, b));
    }
    std::ranges::sort(graph.edges);
    const auto repeated = std::ranges::unique(graph.edges);
    graph.edges.erase(repeated.begin(), repeated.end());
    return graph;
}

void write_lane(const Lane& lane) {
    out.list("left", lane.left).list("right", lane.right).member("closed", lane.closed);
}

void write_stop(const std::optional<StopReason>& stopped_by) {
    if (stopped_by) out.member("stopped_by", to_string(*stopped_by));
}

void write_answer(const LaneAnswer& answer) {
    out.member("status", to_string(answer.status));
    write_stop(answer.stopped_by);
    write_lane(answer.lane);
    out.member("confidence", answer.confidence).member("trusted_m", answer.trusted_m);
    if (answer.optimality) {
        out.member("objective", answer.optimality->objective).member("bound", answer.optimality->bound);
        out.member("optimal", answer.optimality->optimal);
    }
    if (answer.enumeration) {
        out.member("iterations", answer.enumeration->iterations);
        out.member("complete", answer.enumeration->complete);
    }
    if (!answer.message.empty()) out.member("message", std::string_view(answer.message));
}

void write_centre_line(const DrivableLane& lane) {
    out.key("points").begin('[');
    for (const DrivablePoint& point : lane.points) {
        out.begin('{')
            .member("s_m", point.s_m)
            .member("x", point.position.x())
            .member("y", point.position.y());
        out.member("heading_rad", point.heading_rad).member("curvature_1pm", point.curvature_1pm);
        out.member("width_left_m", point.width_left_m).member("width_right_m", point.width_right_m).end('}');
    }
    out.end(']').member("closed", lane.closed).member("length_m", lane.length_m);
    out.member("trusted_m", lane.trusted_m);
    out.member("left_inferred", lane.left_inferred).member("right_inferred", lane.right_inferred);
}

/// Edge and turn costs of some edges, as the objective of the scene has them.
void write_prices(const Scene& scene, const RldParameters& parameters, const LaneGraph& graph) {
    const LaneGraphProblem problem = make_problem(scene, parameters);
    const auto id = [&](std::size_t cone) { return scene.cones[cone].id; };
    std::vector<std::size_t> listed;
    out.key("edges").begin('[');
    for (const Edge& edge : graph.edges) {
        const auto known = std::ranges::find_if(
            problem.edges, [&](const ProblemEdge& one) { return one.i == edge.i && one.j == edge.j; });
        // An edge that (27) forbids is not listed; its spacing cost is computed from the two cones alone.
        const Scene pair{"", scene.pose, {scene.cones[edge.i], scene.cones[edge.j]}};
        const LaneGraphProblem alone = make_problem(pair, parameters, EdgeExtent::all_pairs);
        const bool is_listed = known != problem.edges.end();
        const ProblemEdge& priced = is_listed ? *known : alone.edges.front();
        if (is_listed) listed.push_back(static_cast<std::size_t>(known - problem.edges.begin()));
        out.begin('{').member("from", id(edge.i)).member("to", id(edge.j));
        out.member("spacing_cost", priced.spacing_cost).member("heading_cost", priced.heading_cost);
        out.member("cost", priced.cost).member("along_heading", priced.along_heading);
        out.member("high_cost", priced.high_cost).end('}');
    }
    out.end(']').key("turns").begin('[');
    for (const ProblemTurn& turn : problem.turns) {
        if (std::ranges::find(listed, turn.edge_i) == listed.end()) continue;
        if (std::ranges::find(listed, turn.edge_k) == listed.end()) continue;
        const auto other = [&](std::size_t edge) {
            const ProblemEdge& one = problem.edges[edge];
            return id(one.i == turn.middle ? one.j : one.i);
        };
        out.begin('{').member("from", other(turn.edge_i)).member("middle", id(turn.middle));
        out.member("to", other(turn.edge_k)).member("angle_cost", turn.angle_cost).member("cost", turn.cost);
        out.member("high_cost", turn.high_cost).end('}');
    }
    out.end(']');
}

/// Begins the answer: an object.
void begin() {
    out.clear();
    out.begin('{');
}

}  // namespace
}  // namespace conelane::playground

using namespace conelane;
using namespace conelane::playground;

/// Room for this many doubles, until the next call.
CONELANE_EXPORT(conelane_room) double* conelane_room(std::size_t count) {
    room.assign(count, 0.0);
    return room.data();
}

CONELANE_EXPORT(conelane_text) const char* conelane_text() {
    return out.text().data();
}

CONELANE_EXPORT(conelane_text_size) std::size_t conelane_text_size() {
    return out.text().size();
}

/// Version, names and ranges: the values that a host may use.
CONELANE_EXPORT(conelane_describe) void conelane_describe() {
    begin();
    out.member("version", version()).key("methods").begin('[');
    for (const DetectorInfo& one : detectors()) {
        out.begin('{').member("name", one.name).member("description", one.description).end('}');
    }
    out.end(']').key("parameters").begin('[');
    const RldParameters defaults;
    for (const RldParameterField& field : parameter_fields()) {
        out.begin('{')
            .member("key", field.key)
            .member("unit", field.unit)
            .member("default", defaults.*field.value);
        out.member("lowest", field.lowest).member("highest", field.highest);
        out.member("description", field.description).end('}');
    }
    out.end(']').list("courses", generated_track_names()).end('}');
}

/// `nearest` below 0: all cones. `parameters`: none, or those of read_parameters.
CONELANE_EXPORT(conelane_detect)
void conelane_detect(const char* name, std::size_t name_size, const double* scene_numbers,
                     std::size_t scene_count, const double* parameters, std::size_t parameter_count,
                     double nearest, double limit_ms) {
    const std::string asked(name, name_size);
    const Scene scene = read_scene({scene_numbers, scene_count});
    DetectorOptions options;
    if (parameter_count > 0) options.rld_parameters = read_parameters({parameters, parameter_count});
    if (nearest >= 0.0) options.nearest = static_cast<std::size_t>(nearest);
    std::unique_ptr<LaneDetector> made;
    LaneDetector* detector = nullptr;
    if (parameter_count > 0 || nearest >= 0.0) {
        made = make_detector(asked, options);
        detector = made.get();
    } else {
        auto kept = kept_detectors.find(asked);
        if (kept == kept_detectors.end()) kept = kept_detectors.emplace(asked, make_detector(asked)).first;
        detector = kept->second.get();
    }
    const Stopwatch watch;
    const LaneAnswer answer = detector->detect(scene, {.time_limit_ms = limit_ms});
    const double latency_ms = watch.elapsed_ms();
    begin();
    out.member("method", std::string_view(asked));
    write_answer(answer);
    out.member("latency_ms", latency_ms).key("merged").begin('[');
    for (const MergedCone& one : answer.merged) out.begin('[').value(one.cone).value(one.into).end(']');
    out.end(']').end('}');
}

/// Detectors forget earlier scenes.
CONELANE_EXPORT(conelane_reset) void conelane_reset() {
    for (auto& [name, detector] : kept_detectors) detector->reset();
}

/// `ids`: the `left` ids of the left boundary, then those of the right one.
CONELANE_EXPORT(conelane_centre_line)
void conelane_centre_line(const double* scene_numbers, std::size_t scene_count, const double* ids,
                          std::size_t id_count, std::size_t left, int closed, double step_m,
                          double smoothing_m, double max_gap_m, double default_width_m) {
    Lane lane;
    for (std::size_t i = 0; i < id_count; ++i) {
        (i < left ? lane.left : lane.right).push_back(static_cast<ConeId>(ids[i]));
    }
    lane.closed = closed != 0;
    const DrivableOptions options{step_m, smoothing_m, max_gap_m, default_width_m};
    const DrivableLane line = drivable(lane, read_scene({scene_numbers, scene_count}), options);
    begin();
    write_centre_line(line);
    out.end('}');
}

/// The exact solver path-pair.
CONELANE_EXPORT(conelane_solve)
void conelane_solve(const double* scene_numbers, std::size_t scene_count, const double* parameters,
                    std::size_t parameter_count, double limit_ms) {
    const Scene scene = read_scene({scene_numbers, scene_count});
    const auto entry = std::ranges::find(core_solvers(), "path-pair", &RldSolverEntry::name);
    const std::unique_ptr<RldSolver> solver = entry->make(Formulation::tight);
    const SolvedScene solved = solve_scene(*solver, scene, read_parameters({parameters, parameter_count}),
                                           {.limits = {.time_limit_ms = limit_ms}});
    const RldReport& report = solved.report;
    begin();
    out.member("status", to_string(report.status));
    write_stop(report.stopped_by);
    out.key("edges").begin('[');
    if (report.lane_graph) {
        for (const Edge& edge : report.lane_graph->edges) {
            out.begin('[').value(scene.cones[edge.i].id).value(scene.cones[edge.j].id).end(']');
        }
    }
    out.end(']');
    write_lane(report.lane_graph ? to_lane(*report.lane_graph, scene).value_or(Lane{}) : Lane{});
    out.member("objective", report.objective).member("bound", report.bound).member("nodes", report.nodes);
    out.member("candidate_edges", solved.problem.edges.size()).member("total_ms", solved.total_ms);
    if (!report.message.empty()) out.member("message", std::string_view(report.message));
    out.end('}');
}

/// The verdict of the independent checker on a set of edges, given as pairs of ids.
CONELANE_EXPORT(conelane_check)
void conelane_check(const double* scene_numbers, std::size_t scene_count, const double* parameters,
                    std::size_t parameter_count, const double* ids, std::size_t id_count) {
    const Scene scene = read_scene({scene_numbers, scene_count});
    validate(scene);
    const CheckReport report =
        check(scene, read_parameters({parameters, parameter_count}), read_edges(scene, {ids, id_count}));
    begin();
    out.list("violations", report.violations).member("objective", report.objective);
    out.member("is_final", report.is_final).end('}');
}

/// The costs of edges and of their turns with each other.
CONELANE_EXPORT(conelane_price)
void conelane_price(const double* scene_numbers, std::size_t scene_count, const double* parameters,
                    std::size_t parameter_count, const double* ids, std::size_t id_count) {
    const Scene scene = read_scene({scene_numbers, scene_count});
    validate(scene);
    begin();
    write_prices(scene, read_parameters({parameters, parameter_count}), read_edges(scene, {ids, id_count}));
    out.end('}');
}

/// Starts the planner of a run, instead of the last one. `mission` as in Mission; `laps` below 1: the default
/// of the mission.
CONELANE_EXPORT(conelane_start_planner)
void conelane_start_planner(int mission, int laps, const char* name, std::size_t name_size) {
    PlannerOptions options{.mission = static_cast<Mission>(mission),
                           .detector = std::string(name, name_size)};
    if (laps >= 1) options.laps = laps;
    planner = make_planner(options);
}

/// Precondition: a planner was started. Cones without id have NaN.
CONELANE_EXPORT(conelane_plan)
void conelane_plan(double time_s, const double* scene_numbers, std::size_t scene_count, double limit_ms) {
    Scene scene = read_scene({scene_numbers, scene_count});
    const Stopwatch watch;
    const Plan plan = planner->update({.time_s = time_s, .pose = scene.pose, .cones = std::move(scene.cones)},
                                      {.time_limit_ms = limit_ms});
    const double latency_ms = watch.elapsed_ms();
    begin();
    out.member("state", to_string(plan.state)).member("safe_m", plan.safe_m).member("age_s", plan.age_s);
    out.member("lap", plan.lap).member("stop", plan.stop).member("phase", plan.phase);
    out.member("reason", plan.reason);
    if (plan.stop_line_m) out.member("stop_line_m", *plan.stop_line_m);
    out.member("latency_ms", latency_ms).key("lane").begin('{');
    write_centre_line(plan.lane);
    out.end('}').key("answer").begin('{');
    write_answer(plan.answer);
    out.end('}').end('}');
}

/// A generated course, with the poses of its centre line.
CONELANE_EXPORT(conelane_course)
void conelane_course(const char* name, std::size_t name_size, double seed, double every_m) {
    const Track track = generate_track(std::string(name, name_size), static_cast<std::uint64_t>(seed));
    begin();
    out.member("name", std::string_view(track.name)).member("closed", track.closed).key("cones").begin('[');
    for (const Cone& cone : track.cones) {
        out.begin('{').member("id", cone.id).member("x", cone.position.x()).member("y", cone.position.y());
        out.member("color", to_string(cone.color)).end('}');
    }
    out.end(']').list("left", track.left).list("right", track.right).key("line").begin('[');
    for (const Pose& pose : centre_line_poses(boundaries(track), every_m)) {
        out.begin('[').value(pose.position.x()).value(pose.position.y()).value(pose.yaw_rad).end(']');
    }
    out.end(']').end('}');
}
