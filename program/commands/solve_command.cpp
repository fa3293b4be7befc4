#include "conelane/solve_scene.hpp"
#include "evaluation/formats/solution_file.hpp"
#include "evaluation/outside/outside_solver.hpp"
#include "evaluation/progress/progress.hpp"
#include "evaluation/proofs/answer_check.hpp"
#include "program/commands/command_parts.hpp"
#include "solvers/milp/milp_solver.hpp"
#include "solvers/registry.hpp"

#include <fmt/ranges.h>

namespace conelane::program {
namespace {

struct Options {
    std::string solver = "cbc";
    std::string formulation = "tight";
    std::string scenes;
    std::string out;
    std::optional<std::size_t> nearest;
    ParameterSource parameters;
    SolveLimits limits;
    bool warm_start = false;
    std::string start;  ///< a file of lanes
    bool all_rows = false;
};

/// A solver, and its name in records.
struct ChosenSolver {
    std::unique_ptr<RldSolver> solver;
    std::string name;
    std::string formulation;
};

ChosenSolver choose(const Options& options) {
    const Formulation formulation = options.formulation == "paper" ? Formulation::paper : Formulation::tight;
    if (const auto outside = parse_outside_solver(options.solver)) {
        const OutsideSolverOptions how{outside->formulation.value_or(formulation), options.all_rows};
        return {std::make_unique<OutsideSolver>(*outside, how), outside->name,
                std::string(to_string(how.formulation))};
    }
    const RldSolverEntry* entry = find_rld_solver(options.solver);
    if (entry == nullptr) {
        throw InvalidInput("--solver",
                           "there is no solver '" + options.solver + "', see `conelane methods --solvers`");
    }
    if (!options.all_rows) return {entry->make(formulation), options.solver, options.formulation};
    const MilpBackend* const milp = find_milp_backend(options.solver);
    if (milp == nullptr)
        throw InvalidInput("--all-rows", "'" + options.solver + "' solves no program, so there are no rows");
    return {make_milp_rld_solver(
                [milp](const BinaryProgram& program, std::uint64_t) { return milp->load(program); },
                {formulation, true}),
            options.solver, options.formulation};
}

/// The number of scenes by status, in the order in which the statuses first occur.
std::string status_counts(const std::vector<SolutionRecord>& records) {
    std::vector<std::pair<std::string, std::size_t>> counts;
    for (const SolutionRecord& record : records) {
        const auto known = std::ranges::find(counts, record.status, &decltype(counts)::value_type::first);
        if (known == counts.end()) {
            counts.emplace_back(record.status, 1);
        } else {
            ++known->second;
        }
    }
    std::vector<std::string> parts;
    parts.reserve(counts.size());
    for (const auto& [status, count] : counts) parts.push_back(fmt::format("{} {}", count, status));
    return fmt::format("{}", fmt::join(parts, ", "));
}

/// The lanes of a file by scene. Throws InputError where a scene has two.
std::map<std::string, Lane> starting_lanes(const std::string& file) {
    std::map<std::string, Lane> lanes;
    for (const LaneRecord& record : read_lanes(file)) {
        if (record.answer.status != LaneStatus::found || record.points) continue;
        if (!lanes.emplace(record.scene, record.answer.lane).second)
            throw InputError(file, record.line, "scene",
                             "'" + record.scene + "' has two lanes to start from");
    }
    return lanes;
}

void solve_all(const Options& options) {
    const RldParameters parameters = options.parameters.load();
    const ParameterTag tag = tag_of(options.parameters.name, parameters);
    const auto [solver, name, formulation] = choose(options);
    const std::vector<AnnotatedScene> scenes = read_scenes(options.scenes);
    std::vector<SolutionRecord> records;
    records.reserve(scenes.size());
    std::optional<std::pair<Scene, LaneGraph>> previous;
    std::map<std::string, Lane> lanes;
    if (!options.start.empty()) lanes = starting_lanes(options.start);
    std::size_t started = 0;
    Progress progress(name, scenes.size());
    for (const AnnotatedScene& annotated : scenes) {
        const Scene scene = cones_asked_for(annotated.scene, options.nearest);
        std::optional<LaneGraph> start;
        if (options.warm_start && previous) start = map_by_cone_id(previous->first, previous->second, scene);
        if (const auto lane = lanes.find(scene.id); lane != lanes.end() && !lane->second.closed)
            start = lane_graph_of(lane->second, scene);
        if (start && !options.start.empty()) ++started;
        const RldReport report = solve_scene(*solver, scene, parameters,
                                             {.limits = options.limits, .start = start ? &*start : nullptr})
                                     .report;
        SolutionRecord record{scene.id,         name,
                              formulation,      std::string(to_string(report.status)),
                              report.message,   {},
                              report.objective, report.bound,
                              report.nodes,     report.build_ms,
                              report.solve_ms,  report.stopped_by,
                              options.nearest,  tag};
        if (report.lane_graph) {
            for (const Edge& edge : report.lane_graph->edges) {
                record.edges.emplace_back(scene.cones[edge.i].id, scene.cones[edge.j].id);
            }
        }
        if (report.lane_graph) previous.emplace(scene, *report.lane_graph);
        records.push_back(std::move(record));
        progress.advance();
    }
    write_solutions(options.out, records);
    AnswerErrors errors;
    for (const SolutionRecord& record : records) {
        if (record.status == to_string(SolveStatus::error)) {
            errors.add_error(record.solver, record.scene, record.message);
        } else {
            errors.add_answer(record.solver);
        }
    }
    if (!options.start.empty()) fmt::print("{} started from a lane of {}\n", started, options.start);
    fmt::print("{} scenes: {}, in {}\n", records.size(), status_counts(records), options.out);
    report_errors(errors);
}

}  // namespace

void add_solve_command(CLI::App& program) {
    CLI::App& command =
        *program.add_subcommand("solve", "RLD solutions of scenes: the lane graph of least cost");
    auto options = std::make_shared<Options>();
    command
        .add_option(
            "--solver", options->solver,
            "see `conelane methods --solvers`; or exec:NAME=COMMAND, a program that solves MPS or LP files "
            "(docs/from-outside.md)")
        ->capture_default_str();
    command.add_flag(
        "--all-rows", options->all_rows,
        "a solver of programs gets one with all rows (no cycles and the pairing as a flow) and is asked "
        "once; without it, rows that its point violates are added and it is asked again");
    add_word_option(command, "--formulation", options->formulation, {"tight", "paper"},
                    "the program, for solvers that use one: tight, or paper as printed");
    command.add_option("--scenes", options->scenes, "*.scenes.jsonl")->required();
    add_output_option(command, "--out", options->out, "*.solutions.jsonl")->required();
    add_nearest_option(command, options->nearest, "the N nearest cones ahead only; all without it");
    add_time_limit_option(command, options->limits.time_limit_ms);
    CLI::Option& warm_start =
        *command.add_flag("--warm-start", options->warm_start,
                          "start from the lane graph of the scene before, its cones found again by id");
    command
        .add_option("--start", options->start,
                    "*.lanes.jsonl: start from the lanes that another method has found in these scenes; a "
                    "closed lane and one with cones that the scene lacks start nothing, and one that RLD's "
                    "constraints forbid is no answer")
        ->excludes(&warm_start);
    add_parameter_options(command, options->parameters, "the defaults");
    command.callback([options] { solve_all(*options); });
}

}  // namespace conelane::program
