#include "conelane/core_solvers.hpp"
#include "conelane/invalid_input.hpp"
#include "conelane/learned_costs.hpp"
#include "conelane/solve_scene.hpp"
#include "python/bindings/bindings.hpp"

namespace conelane::python {
namespace {

/// A solved scene and its lane, which is empty if there is none.
struct SolutionObject : RldReport {
    double total_ms = 0.0;
    std::vector<Cone> cones;
    Lane lane;
};

const RldSolverEntry& find_solver(const std::string& name) {
    const auto solvers = core_solvers();
    const auto entry = std::ranges::find(solvers, name, &RldSolverEntry::name);
    if (entry != solvers.end()) return *entry;
    std::string names;
    for (const RldSolverEntry& known : solvers)
        names += (names.empty() ? "" : ", ") + std::string(known.name);
    throw InvalidInput("solver", "there is no solver '" + name + "', only " + names);
}

SolutionObject solve_rld(const py::object& cones, const py::object& pose, const py::object& ids,
                         const py::object& colors, const py::object& confidences,
                         const py::object& parameters, const std::optional<std::string>& pairing,
                         const std::string& solver_name, std::optional<double> time_limit_ms,
                         double absolute_gap) {
    Scene scene{"", python::pose(pose), python::cones(cones, ids, colors, confidences, py::none())};
    RldParameters chosen = rld_parameters(parameters).value_or(RldParameters{});
    if (pairing) chosen.pairing = pairing_of(*pairing);
    const RldSolverEntry& entry = find_solver(solver_name);
    const SolveLimits limits{limit_of(time_limit_ms), absolute_gap};
    if (const std::string_view fault = invalidity(limits); !fault.empty())
        throw InvalidInput("limits", std::string(fault));
    validate(scene);
    validate(chosen);
    const py::gil_scoped_release unlocked;
    SolvedScene solved = solve_scene(*entry.make(Formulation::tight), scene, chosen, {.limits = limits});
    std::optional<Lane> lane;
    if (solved.report.lane_graph) lane = to_lane(*solved.report.lane_graph, scene);
    return {std::move(solved.report), solved.total_ms, std::move(scene.cones),
            std::move(lane).value_or(Lane{})};
}

Indices edges(const SolutionObject& solution) {
    std::vector<std::int64_t> ends;
    for (const Edge& edge : solution.lane_graph ? solution.lane_graph->edges : std::vector<Edge>{}) {
        ends.push_back(static_cast<std::int64_t>(edge.i));
        ends.push_back(static_cast<std::int64_t>(edge.j));
    }
    return array(ends).reshape({static_cast<py::ssize_t>(ends.size() / 2), py::ssize_t{2}});
}

py::dict parameters_as_dict(const std::string& name) {
    const RldParameters parameters = *rld_parameters(py::str(name));
    py::dict all;
    for (const auto fields : {rld_parameter_fields(), rld_extra_fields()}) {
        for (const RldParameterField& field : fields)
            all[py::str(std::string(field.key))] = parameters.*field.value;
    }
    all["pairing"] = to_string(parameters.pairing);
    all["use_confidence"] = parameters.use_confidence;
    all["forbid_crossing"] = parameters.forbid_crossing;
    if (parameters.learned_costs)
        all["learned_costs"] = std::const_pointer_cast<LearnedCosts>(parameters.learned_costs);
    return all;
}

constexpr const char* kSolveRld =
    R"(solve_rld(cones: ArrayLike, pose: ArrayLike, ids: Optional[ArrayLike] = None, colors: Optional[ArrayLike] = None,
          confidences: Optional[ArrayLike] = None, *, parameters: Optional[Union[str, Mapping[str, Any]]] = None,
          pairing: Optional[str] = None, solver: str = 'path-pair', time_limit_ms: Optional[float] = None,
          absolute_gap: float = 1e-09) -> RldSolution

The lane graph of least cost: RLD, solved to its proven optimum unless a limit ends the search.

cones, pose, ids, colors, confidences: As `Detector.detect` takes them.
parameters: Name of a parameter set, or a dict of the values that differ from `rld_parameters()`.
pairing: "near_far" or "paper", instead of the parameters'.
solver: "path-pair", or "exhaustive" for at most 9 cones; both are exact.
time_limit_ms: Wall clock [ms]; None for no limit.
absolute_gap: A lane graph whose cost is this close to the bound counts as optimal.
Raises ValueError as `Detector.detect`, and for unknown names and for parameters and limits out of range.

>>> import conelane
>>> cones = [[1, -1.5], [1, 1.5], [4, -1.5], [4, 1.5], [7, -1.5], [7, 1.5]]
>>> solution = conelane.solve_rld(cones, (0, 0, 0))
>>> solution.status
'optimal'
>>> solution.edges.tolist()
[[0, 2], [1, 3], [2, 4], [3, 5]]
>>> round(solution.objective, 3), round(solution.bound, 3)
(-4.0, -4.0)
)";

constexpr const char* kRldParameters = R"(rld_parameters(name: str = 'default') -> Dict[str, Any]

Parameters of the RLD model.

name: "default" or one of the tuned sets; an unknown name lists them.
Returns lengths in metres, angles in radians. Where the set has learned costs, `learned_costs` is a `LearnedCosts`; a
    file that ``conelane train rld`` wrote may stand in its place.

>>> import conelane
>>> conelane.rld_parameters()["d_max"]
6.5
>>> conelane.rld_parameters("tuned")
Traceback (most recent call last):
    ...
ValueError: parameters: there is no set 'tuned', only default, n12, context, shape, full, learned
)";

}  // namespace

void add_rld(py::module_& module) {
    // NOLINTNEXTLINE(bugprone-unused-raii)
    Class<LearnedCosts, std::shared_ptr<LearnedCosts>>(module, "LearnedCosts",
                                                       "Costs of a set of `rld_parameters`.");
    Class<SolutionObject>(module, "RldSolution", "What `solve_rld` found. Every attribute is a copy.")
        .get(
            "status",
            R"(str: "optimal", "feasible" (a limit ended the proof), "infeasible" (by proof), "stopped" (a limit ended the search
before any lane graph) or "error")",
            &SolutionObject::status, kName)
        .get("stopped_by",
             R"(Optional[str]: the limit that ended the search: "time", "memory" or "iterations")",
             &SolutionObject::stopped_by, kName)
        .get("edges", "NDArray[int64]: (K, 2), the lane graph, as indices into the cones", edges)
        .get("objective", "Optional[float]: cost of the lane graph", &RldReport::objective)
        .get("bound", "Optional[float]: proven lower bound of the least cost", &RldReport::bound)
        .get("nodes", "int: of the search tree", &RldReport::nodes)
        .get("total_ms", "float: wall clock [ms]", &SolutionObject::total_ms)
        .get("message", "str: of an error", &RldReport::message)
        .get("left", "NDArray[int64]: (L,), left boundary from the car outward, as indices into the cones",
             [](const SolutionObject& s) { return array(indices_of(s.lane.left, s.cones, "left")); })
        .get("right", "NDArray[int64]: (R,), right boundary",
             [](const SolutionObject& s) { return array(indices_of(s.lane.right, s.cones, "right")); })
        .repr([](const SolutionObject& s) {
            const std::string reason =
                s.stopped_by ? ", stopped by " + std::string(to_string(*s.stopped_by)) : "";
            return py::str("<conelane.RldSolution {}{}>").format(to_string(s.status), reason);
        });
    add_function(module, kSolveRld, solve_rld);
    add_function(module, kRldParameters, parameters_as_dict);
}

}  // namespace conelane::python
