#include "evaluation/formats/program_files.hpp"
#include "evaluation/formats/program_solution.hpp"
#include "evaluation/formats/solution_file.hpp"
#include "evaluation/proofs/answer_check.hpp"
#include "model/connecting_flow.hpp"
#include "model/lane_graph_model.hpp"
#include "model/strip_model.hpp"
#include "program/commands/command_parts.hpp"

// Export and import are about the program of one scene. Rows that a solve adds on demand, (5) and the
// pairing, are too many to write in full; a flow replaces them. With --rows-on-demand the file has neither:
// its optimum is only a bound for the scene, unless its point is a lane graph.
namespace conelane::program {
namespace {

/// The scene of the program.
struct ProgramSource {
    std::string scenes;
    std::string id;
    std::string formulation = "tight";
    std::optional<std::size_t> nearest;
    ParameterSource parameters;
    bool all_rows = true;
};

void add_program_options(CLI::App& command, ProgramSource& source) {
    command.add_option("--scenes", source.scenes, "*.scenes.jsonl")->required();
    command.add_option("--id", source.id, "id of the scene")->required();
    add_word_option(command, "--formulation", source.formulation, {"tight", "paper", "strip"},
                    "rows and columns of the program: tight, paper as printed, or strip, with hand-set "
                    "costs or with the limits and costs of --params");
    add_nearest_option(command, source.nearest, "the N nearest cones ahead only; all without it");
    add_parameter_options(command, source.parameters, "the defaults");
    command.add_flag(
        "--all-rows,!--rows-on-demand", source.all_rows,
        "no cycles and the pairing are in the file, as columns and rows of a flow, so its optimum "
        "is that of the scene (the default); --rows-on-demand leaves them out");
}

Scene scene_of(const ProgramSource& source) {
    return cones_asked_for(scene_named(source.id, source.scenes).scene, source.nearest);
}

/// The program of a scene, with everything that it refers to.
class SceneProgram {
  public:
    explicit SceneProgram(const ProgramSource& source)
        : scene(scene_of(source)),
          formulation(source.formulation == "paper" ? Formulation::paper : Formulation::tight),
          parameters(source.parameters.load()),
          problem(make_problem(scene, parameters, parts(formulation).extent)),
          model(problem, formulation),
          program(whole(source.all_rows)) {}
    SceneProgram(const SceneProgram&) = delete;
    SceneProgram& operator=(const SceneProgram&) = delete;

    const Scene scene;
    const Formulation formulation;
    const RldParameters parameters;
    const LaneGraphProblem problem;
    const LaneGraphModel model;
    const BinaryProgram program;  ///< the model's program, with all rows if requested

  private:
    [[nodiscard]] BinaryProgram whole(bool all_rows) const {
        BinaryProgram made = model.program();
        if (all_rows) add_connecting_flow(made, problem);
        return made;
    }
};

struct ExportOptions {
    ProgramSource source;
    std::string out;
    std::string solution;  ///< without it, the program is exported
    std::string solver = "import";
    double time_limit_ms = 10'000.0;  ///< of the proof
};

void write_program(const ExportOptions& options, const BinaryProgram& program) {
    const std::string ending = std::filesystem::path(options.out).extension().string();
    if (ending != ".mps" && ending != ".lp")
        throw InvalidInput("--out", "'" + options.out + "' does not end in .mps or .lp");
    AtomicFile file(options.out);
    // A name must be one word in these formats.
    (ending == ".mps" ? write_mps : write_lp)(file.stream(), program,
                                              "conelane_" + options.source.formulation);
    file.commit();
    fmt::print("{} columns and {} rows in {}\n", program.columns.size(), program.rows.size(), options.out);
}

void export_strip(const ExportOptions& options) {
    const StripParameters parameters = options.source.parameters.name.empty()
                                           ? driving_strip_parameters()
                                           : strip_parameters_of(options.source.parameters.load());
    const StripProblem problem = make_strip_problem(scene_of(options.source), parameters);
    StripModel model(problem);
    if (model.build(Deadline())) throw InvalidInput("--id", "the program of the scene is too large");
    write_program(options, model.program());
}

void export_program(const ExportOptions& options) {
    if (options.source.formulation == "strip") return export_strip(options);
    write_program(options, SceneProgram(options.source).program);
}

SolutionFile read_solution(const std::string& path, const BinaryProgram& program) {
    std::ifstream in(path);
    if (!in) throw InputError(path, 0, "", "cannot be read");
    try {
        SolutionFile solution = read_solution_file(in, program);
        if (const std::string fault = fault_of(solution, program); !fault.empty())
            throw InputError(path, 0, "", fault);
        return solution;
    } catch (const InvalidInput& error) {
        throw InputError(path, 0, "", error.what());
    }
}

/// The file's claim that the scene has no better lane graph, or none. Throws InputError if it is wrong.
ClaimVerdict judge(const SceneProgram& program, const ExportOptions& options, double bound) {
    ClaimVerdict verdict =
        judge_bound(program.scene, program.parameters, bound, options.solver, options.time_limit_ms);
    if (verdict.kind != ClaimVerdict::Kind::wrong) return verdict;
    throw InputError(options.solution, 0, "",
                     std::isinf(bound)
                         ? fmt::format("says that there is no solution, {} found one of {:.9g}", verdict.by,
                                       *verdict.objective)
                         : fmt::format("claims that nothing is below {:.9g}, {} found a lane graph of {:.9g}",
                                       bound, verdict.by, *verdict.objective));
}

/// What holds of the scene: an optimum or infeasibility only if it is proven here. A point that is not a lane
/// graph is an error.
SolutionRecord to_record(const SolutionFile& solution, const SceneProgram& program,
                         const ExportOptions& options) {
    using Status = SolutionFile::Status;
    SolutionRecord record;
    record.scene = program.scene.id;
    record.solver = options.solver;
    record.formulation = options.source.formulation;
    record.nearest = options.source.nearest;
    record.parameters = tag_of(options.source.parameters.name, program.parameters);
    record.status = "error";
    if (solution.status == Status::infeasible) {
        const ClaimVerdict verdict = judge(program, options, std::numeric_limits<double>::infinity());
        if (verdict.kind == ClaimVerdict::Kind::proven) record.status = "infeasible";
        record.message = verdict.kind == ClaimVerdict::Kind::proven ? "proven by " + verdict.by
                                                                    : "infeasibility unverified";
        return record;
    }
    if (solution.point.empty()) {
        record.message = "the file holds no solution";
        return record;
    }
    const LaneGraph graph = program.model.decode(solution.point);
    if (!is_feasible(program.problem, graph)) {
        record.message = "the solution violates (5) or the pairing, which are not in the file";
        return record;
    }
    record.status = "feasible";
    record.objective = objective(program.problem, graph);
    for (const Edge& edge : graph.edges) {
        record.edges.emplace_back(program.scene.cones[edge.i].id, program.scene.cones[edge.j].id);
    }
    const bool is_claimed_optimal = solution.status == Status::optimal;
    if (!is_claimed_optimal && !solution.bound) return record;
    const double bound =
        is_claimed_optimal ? *record.objective : std::min(*solution.bound, *record.objective);
    const ClaimVerdict verdict = judge(program, options, bound);
    const std::string claim = is_claimed_optimal ? "optimum" : fmt::format("bound {:.9g}", bound);
    if (verdict.kind == ClaimVerdict::Kind::proven) {
        if (is_claimed_optimal) record.status = "optimal";
        record.bound = bound;
        record.message = fmt::format("{} proven by {}", claim, verdict.by);
    } else {
        record.message = fmt::format("{} unverified: {} did not decide within {} ms", claim, verdict.by,
                                     options.time_limit_ms);
    }
    return record;
}

void import_solution(const ExportOptions& options) {
    if (options.source.formulation == "strip")
        throw InvalidInput("--formulation", "solutions of strips are not read; tight and paper are");
    const SceneProgram program(options.source);
    const SolutionFile solution = read_solution(options.solution, program.program);
    const SolutionRecord record = to_record(solution, program, options);
    write_solutions(options.out, std::array{record});
    fmt::print("{}{}\n", record.status, record.message.empty() ? "" : ": " + record.message);
}

}  // namespace

void add_export_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand(
        "export",
        "the program of a scene as MPS or LP file, or with --sol another program's solution of that file as "
        "solution of the scene, for `conelane check`.\n"
        "With --rows-on-demand the file leaves out the rows that conelane's solvers add on demand: no cycles "
        "(5), and the pairing near_far. A solution file whose point, objective or bound contradict each "
        "other or the program is refused, and so is an optimum that an own search within the time limit "
        "refutes; one that it does not prove is unverified and counts as feasible. A solution with a cycle "
        "or against the pairing is an error");
    auto options = std::make_shared<ExportOptions>();
    add_program_options(command, options->source);
    CLI::Option& solution =
        *command.add_option("--sol", options->solution,
                            "a solution file of CBC, GLPK, HiGHS, SCIP or Gurobi, or MIPLIB's; the other "
                            "options must be those of the export");
    command.add_option("--solver", options->solver, "name of the solver, for the records")
        ->capture_default_str()
        ->needs(&solution);
    add_time_limit_option(command, options->time_limit_ms);
    command.get_option("--time-limit")->needs(&solution);
    add_output_option(command, "--out", options->out, "*.mps or *.lp; with --sol *.solutions.jsonl")
        ->required();
    command.callback(
        [options] { options->solution.empty() ? export_program(*options) : import_solution(*options); });
}

}  // namespace conelane::program
