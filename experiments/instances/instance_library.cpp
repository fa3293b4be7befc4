#include "experiments/instances/instance_library.hpp"

#include "conelane/invalid_input.hpp"
#include "conelane/lane_graph_problem.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/files/atomic_file.hpp"
#include "evaluation/files/folder_lock.hpp"
#include "evaluation/files/gzip.hpp"
#include "evaluation/files/input_error.hpp"
#include "evaluation/files/program_files.hpp"
#include "evaluation/scenes/scene_set.hpp"
#include "model/lane_graph_model.hpp"
#include "solvers/milp/cbc_main_solver.hpp"
#include "solvers/milp/cbc_solver.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

constexpr std::array kFormulations{Formulation::paper, Formulation::tight};
/// Objectives of two engines may differ by this much: CBC knows them to the tolerance of its LP.
constexpr double kSameObjective = 1e-6;

/// The answer of a MILP solver to a program, and the rows that were added on the way.
struct SolvedProgram {
    MilpReport report;
    std::vector<ProgramRow> added;
};

/// Solves the program and adds the rows that its point violates, until no row is violated or the time ends.
SolvedProgram solve_and_separate(const LaneGraphModel& model, Formulation formulation, double time_limit_ms) {
    const Deadline deadline(time_limit_ms);
    // CBC's full machinery is faster on the printed program, `cbc` on the tight one.
    const std::unique_ptr<MilpSolver> solver =
        formulation == Formulation::paper ? make_cbc_main_solver() : make_cbc_solver();
    const std::unique_ptr<MilpSession> session = solver->load(model.program());
    SolvedProgram solved;
    while (true) {
        solved.report = session->solve({.time_limit_ms = deadline.remaining_ms()});
        if (solved.report.status != SolveStatus::optimal) break;
        std::vector<ProgramRow> violated = model.separate(solved.report.point);
        if (violated.empty()) break;
        session->add_rows(violated);
        for (ProgramRow& row : violated) {
            // Rows of different rounds may have the same name.
            row.label = {"separated", {static_cast<std::int32_t>(solved.added.size())}};
            solved.added.push_back(std::move(row));
        }
    }
    return solved;
}

[[noreturn]] void contradict(const std::string& name, const RldReport& exact, const MilpReport& milp) {
    const auto text = [](const std::optional<double>& value) {
        return value ? fmt::format("{:.9g}", *value) : std::string("none");
    };
    throw std::logic_error(fmt::format("{}: path-pair says {} ({}), CBC {} ({})", name,
                                       to_string(exact.status), text(exact.objective), to_string(milp.status),
                                       text(milp.bound)));
}

KnownOptimum optimum_by_both(const std::string& name, const RldReport& exact, const SolvedProgram& solved,
                             const LaneGraphProblem& problem, const LaneGraphModel& model) {
    const MilpReport& milp = solved.report;
    const auto proved = [](SolveStatus status) {
        return status == SolveStatus::optimal || status == SolveStatus::infeasible;
    };
    KnownOptimum known;
    known.best = exact.objective;
    known.bound = milp.bound;
    if (!proved(exact.status) || !proved(milp.status)) return known;
    if (exact.status != milp.status) contradict(name, exact, milp);
    known.status = KnownOptimum::Status::infeasible;
    if (exact.status == SolveStatus::infeasible) return known;
    known.status = KnownOptimum::Status::optimal;
    const LaneGraph graph = model.decode(milp.point);
    if (!is_feasible(problem, graph) ||
        std::abs(objective(problem, graph) - exact.objective.value()) > kSameObjective)
        contradict(name, exact, milp);
    return known;
}

void add_rows(BinaryProgram& program, std::span<const ProgramRow> rows) {
    RowWriter writer(program);
    for (const ProgramRow& row : rows) {
        writer.begin(row.label, row.lower, row.upper);
        for (const auto& [column, coefficient] : row.terms) writer.add(column, coefficient);
        writer.end();
    }
}

/// A scene's id as a file name: "fsd_1/pose_0042/fp_0.30" becomes "fsd_1_pose_0042_fp_0.30".
std::string name_of(const std::string& id, const std::optional<std::size_t>& nearest) {
    std::string name = id + (nearest ? fmt::format("_n{}", *nearest) : "_all");
    for (char& letter : name) {
        if (letter == '/' || static_cast<unsigned char>(letter) <= ' ') letter = '_';
    }
    return name;
}

constexpr const char* kList = "conelane.test";
constexpr const char* kSolutions = "conelane.solu";
constexpr std::string_view kProgramEnding = ".mps.gz";

/// Files that get their names together, once all of them are complete. Until then at most one is open.
class Files {
  public:
    void add(const std::filesystem::path& file, const std::string& content) {
        AtomicFile& output = *files_.emplace_back(std::make_unique<AtomicFile>(file));
        output.stream() << content;
        output.finish();
    }
    void commit() const {
        std::vector<AtomicFile*> all;
        for (const auto& file : files_) all.push_back(file.get());
        commit_together(all);
    }

  private:
    std::vector<std::unique_ptr<AtomicFile>> files_;
};

/// The programs of the library in a folder, by the names in its list. Throws InputError if the folder has a
/// program that the list does not name: it may belong to another library.
std::vector<std::filesystem::path> listed_programs(const std::filesystem::path& folder) {
    std::set<std::string> names;
    std::ifstream list(folder / kList);
    for (std::string name; std::getline(list, name);) names.insert(name);
    std::vector<std::filesystem::path> programs;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (!name.ends_with(kProgramEnding)) continue;
        if (!names.contains(name)) {
            throw InputError(
                folder, 0, "",
                fmt::format("holds {}, which its {} does not name; name another folder", name, kList));
        }
        programs.push_back(entry.path());
    }
    return programs;
}

std::string mps_text(const Instance& instance) {
    std::ostringstream text;
    write_mps(text, instance.program, instance.name);
    return text.str();
}

std::string solution_lines(const Instance& instance) {
    const KnownOptimum& known = instance.optimum;
    if (known.status == KnownOptimum::Status::infeasible) return fmt::format("=inf= {}\n", instance.name);
    // Twelve digits: the engines agree on no more, and sums differ between machines after them.
    if (known.status == KnownOptimum::Status::optimal)
        return fmt::format("=opt= {} {:.12g}\n", instance.name, known.best.value());
    std::string lines;
    if (known.best) lines += fmt::format("=best= {} {:.12g}\n", instance.name, *known.best);
    if (known.bound && std::isfinite(*known.bound) && std::abs(*known.bound) < kInfinity)
        lines += fmt::format("=bestdual= {} {:.12g}\n", instance.name, *known.bound);
    return lines;
}

}  // namespace

std::vector<InstanceScene> instance_scenes(const InstanceOptions& options) {
    std::vector<InstanceScene> all;
    for (const AnnotatedScene& annotated : make_scene_set(options.tracks, options.scenes).scenes) {
        const Scene& scene = annotated.scene;
        for (const std::optional<std::size_t>& nearest : options.nearest) {
            if (nearest && *nearest >= scene.cones.size()) continue;
            all.push_back({name_of(scene.id, nearest), nearest ? nearest_ahead(scene, *nearest) : scene});
        }
    }
    return all;
}

std::string_view ending_of(Formulation formulation) {
    return formulation == Formulation::paper ? ".printed" : ".tight";
}

std::optional<Instance> make_instance(const Scene& scene, const std::string& name, Formulation formulation,
                                      const InstanceOptions& options) {
    const Deadline no_deadline;
    const LimitedProblem limited =
        make_problem(scene, options.parameters, parts(formulation).extent, no_deadline);
    if (!limited.problem || limited.problem->edges.empty()) return std::nullopt;
    LaneGraphModel model(formulation);
    if (model.update(*limited.problem, no_deadline)) return std::nullopt;
    const std::unique_ptr<RldSolver> path_pair = make_path_pair_solver();
    const RldReport exact =
        solve_scene(*path_pair, scene, options.parameters, {.time_limit_ms = options.time_limit_ms}).report;
    if (exact.status == SolveStatus::error) throw InvalidInput(name, exact.message);
    const SolvedProgram solved = solve_and_separate(model, formulation, options.time_limit_ms);
    Instance instance{name, model.program(), optimum_by_both(name, exact, solved, *limited.problem, model)};
    if (instance.optimum.status != KnownOptimum::Status::open) {
        add_rows(instance.program, solved.added);
    } else if (!solved.added.empty()) {
        instance.optimum.bound.reset();  // it is the bound of a program with more rows
    }
    return instance;
}

InstanceCounts write_instances(const std::filesystem::path& folder, std::span<const InstanceScene> scenes,
                               const InstanceOptions& options, const std::function<void()>& advance) {
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    if (failure) throw InputError(folder, 0, "", "cannot be made: " + failure.message());
    const FolderLock lock(folder);
    remove_abandoned_files(folder);
    const std::vector<std::filesystem::path> earlier = listed_programs(folder);
    InstanceCounts counts;
    Files files;
    std::set<std::filesystem::path> written;
    std::string list;
    std::string solutions;
    for (const InstanceScene& set : scenes) {
        for (const Formulation formulation : kFormulations) {
            const std::string name = set.name + std::string(ending_of(formulation));
            const std::optional<Instance> instance = make_instance(set.scene, name, formulation, options);
            if (advance) advance();
            if (!instance) {
                ++counts.too_large;
                continue;
            }
            const std::string file = name + std::string(kProgramEnding);
            files.add(folder / file, gzipped(mps_text(*instance)));
            written.insert(folder / file);
            list += file + '\n';
            solutions += solution_lines(*instance);
            ++counts.written;
            counts.optimal += instance->optimum.status == KnownOptimum::Status::optimal ? 1 : 0;
            counts.infeasible += instance->optimum.status == KnownOptimum::Status::infeasible ? 1 : 0;
        }
    }
    files.add(folder / kSolutions, solutions);
    files.add(folder / kList, list);
    // After a signal, the folder has either the old library or the new one.
    const auto held = hold_interruption();
    files.commit();
    for (const std::filesystem::path& file : earlier) {
        if (!written.contains(file)) std::filesystem::remove(file);
    }
    return counts;
}

}  // namespace conelane::experiments
