#include "conelane/core_solvers.hpp"
#include "conelane/invalid_input.hpp"
#include "conelane/rld_parameter_sets.hpp"
#include "conelane/solve_scene.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <pybind11/stl.h>

namespace conelane::python {
namespace {

/// A solved scene and its lane, which is empty if there is none.
struct SolutionObject {
    RldReport report;
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
    const SolveLimits limits{time_limit_ms.value_or(std::numeric_limits<double>::infinity()), absolute_gap};
    if (const std::string_view fault = invalidity(limits); !fault.empty())
        throw InvalidInput("limits", std::string(fault));
    validate(scene);
    validate(chosen);
    const py::gil_scoped_release unlocked;
    SolutionObject solution;
    SolvedScene solved = solve_scene(*entry.make(Formulation::tight), scene, chosen, {.limits = limits});
    if (solved.report.lane_graph) {
        if (auto lane = to_lane(*solved.report.lane_graph, scene)) solution.lane = std::move(*lane);
    }
    solution.report = std::move(solved.report);
    solution.total_ms = solved.total_ms;
    solution.cones = std::move(scene.cones);
    return solution;
}

Indices edges(const SolutionObject& solution) {
    const auto count =
        static_cast<py::ssize_t>(solution.report.lane_graph ? solution.report.lane_graph->edges.size() : 0);
    Indices rows({count, py::ssize_t{2}});
    std::int64_t* out = rows.mutable_data();
    if (solution.report.lane_graph) {
        for (const Edge& edge : solution.report.lane_graph->edges) {
            *out++ = static_cast<std::int64_t>(edge.i);
            *out++ = static_cast<std::int64_t>(edge.j);
        }
    }
    return rows;
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
    return all;
}

void add_solution(py::module_& module) {
    py::class_<SolutionObject>(module, "RldSolution", "What `solve_rld` found. Every attribute is a copy.")
        .def_property_readonly(
            "status", [](const SolutionObject& s) { return to_string(s.report.status); },
            R"(str: "optimal", "feasible" (a limit ended the proof), "infeasible" (by proof), "stopped" (a limit
ended the search before any lane graph) or "error")")
        .def_property_readonly(
            "stopped_by",
            [](const SolutionObject& s) -> std::optional<std::string_view> {
                if (!s.report.stopped_by) return std::nullopt;
                return to_string(*s.report.stopped_by);
            },
            R"(str or None: the limit that ended the search: "time", "memory" or "iterations")")
        .def_property_readonly("edges", edges,
                               "(K, 2) ndarray of int64: the lane graph, as indices into the cones")
        .def_property_readonly(
            "objective", [](const SolutionObject& s) { return s.report.objective; },
            "float or None: cost of the lane graph")
        .def_property_readonly(
            "bound", [](const SolutionObject& s) { return s.report.bound; },
            "float or None: proven lower bound of the least cost")
        .def_property_readonly(
            "nodes", [](const SolutionObject& s) { return s.report.nodes; }, "int: of the search tree")
        .def_property_readonly(
            "total_ms", [](const SolutionObject& s) { return s.total_ms; }, "float: wall clock [ms]")
        .def_property_readonly(
            "message", [](const SolutionObject& s) { return s.report.message; }, "str: of an error")
        .def_property_readonly(
            "left", [](const SolutionObject& s) { return array(indices_of(s.lane.left, s.cones, "left")); },
            "(L,) ndarray of int64: left boundary from the car outward, as indices into the cones")
        .def_property_readonly(
            "right",
            [](const SolutionObject& s) { return array(indices_of(s.lane.right, s.cones, "right")); },
            "(R,) ndarray of int64: right boundary")
        .def("__repr__", [](const SolutionObject& s) {
            const std::string reason =
                s.report.stopped_by ? fmt::format(", stopped by {}", to_string(*s.report.stopped_by)) : "";
            return fmt::format("<conelane.RldSolution {}{}>", to_string(s.report.status), reason);
        });
}

}  // namespace

void add_rld(py::module_& module) {
    add_solution(module);
    module.def(
        "solve_rld", solve_rld, py::arg("cones"), py::arg("pose"), py::arg("ids") = py::none(),
        py::arg("colors") = py::none(), py::arg("confidences") = py::none(), py::kw_only(),
        py::arg("parameters") = py::none(), py::arg("pairing") = py::none(), py::arg("solver") = "path-pair",
        py::arg("time_limit_ms") = py::none(), py::arg("absolute_gap") = 1e-9,
        R"(solve_rld(cones, pose, ids=None, colors=None, confidences=None, *, parameters=None, pairing=None, solver='path-pair', time_limit_ms=None, absolute_gap=1e-09)

The lane graph of least cost: RLD, solved to its proven optimum.

Parameters
----------
cones, pose, ids, colors, confidences
    As `Detector.detect` takes them.
parameters : str or dict, optional
    Name of a parameter set, or a dict of the values that differ from the defaults; see `rld_parameters`.
pairing : str, optional
    "near_far" or "paper", instead of the parameters'.
solver : str
    "path-pair", or "exhaustive" for at most 9 cones; both are exact.
time_limit_ms : float or None
    Wall clock [ms]; None for no limit.
absolute_gap : float
    A lane graph whose cost is this close to the bound counts as optimal.

Returns
-------
RldSolution

Raises
------
ValueError
    As `Detector.detect`, and for unknown names and parameters out of range.

Examples
--------
>>> import conelane
>>> cones = [[1, -1.5], [1, 1.5], [4, -1.5], [4, 1.5], [7, -1.5], [7, 1.5]]
>>> solution = conelane.solve_rld(cones, (0, 0, 0))
>>> solution.status
'optimal'
>>> solution.edges.tolist()
[[0, 2], [1, 3], [2, 4], [3, 5]]
>>> round(solution.objective, 3), round(solution.bound, 3)
(-4.0, -4.0)
)");
    module.def("rld_parameters", parameters_as_dict, py::arg("name") = "default",
               R"(rld_parameters(name='default')

Parameters of the RLD model.

Parameters
----------
name : str
    "default" or one of the tuned sets; an unknown name lists them.

Returns
-------
dict of str to float, str or bool
    Lengths in metres, angles in radians.

Examples
--------
>>> import conelane
>>> conelane.rld_parameters()["d_max"]
6.5
>>> conelane.rld_parameters("tuned")
Traceback (most recent call last):
    ...
ValueError: parameters: there is no set 'tuned', only default, n12, context, shape, full, learned
)");
}

}  // namespace conelane::python
