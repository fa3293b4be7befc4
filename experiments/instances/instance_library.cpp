#include "experiments/instances/instance_library.hpp"

#include "conelane/solve_scene.hpp"
#include "evaluation/formats/file_text.hpp"
#include "evaluation/formats/program_files.hpp"
#include "evaluation/outside/outside_solver.hpp"
#include "evaluation/world/generated_tracks.hpp"
#include "experiments/options/command_line.hpp"
#include "model/connecting_flow.hpp"
#include "solvers/milp/milp_solver.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"

#include <set>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

/// Files that get their names together, once all of them are complete. Until then at most one is open.
class FilesTogether {
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

constexpr std::array kFormulations{Formulation::paper, Formulation::tight};
/// Objectives of two engines may differ by this much: CBC knows them to the tolerance of its LP.
constexpr double kSameObjective = 1e-6;

/// The answer of a MILP solver to a program, and the rows that were added on the way.
struct SolvedProgram {
    std::string engine;
    MilpReport report;
    std::vector<ProgramRow> added;
    double time_ms = 0.0;
};

/// Solves the program and adds the rows that its point violates, until no row is violated or the time ends.
SolvedProgram solve_and_separate(const LaneGraphModel& model, const BinaryProgram& program,
                                 const MilpBackend& backend, double time_limit_ms) {
    const Deadline deadline(time_limit_ms);
    const Stopwatch watch;
    const std::unique_ptr<MilpSession> session = backend.load(program);
    SolvedProgram solved{std::string(backend.entry.name), {}, {}, 0.0};
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
    solved.time_ms = watch.elapsed_ms();
    return solved;
}

/// Throws InvalidInput if the answer is an error.
SolvedScene solve_exactly(const Scene& scene, const std::string& name, const RldParameters& parameters,
                          double time_limit_ms) {
    const std::unique_ptr<RldSolver> path_pair = make_path_pair_solver();
    SolvedScene solved =
        solve_scene(*path_pair, scene, parameters, {.limits = {.time_limit_ms = time_limit_ms}});
    if (solved.report.status == SolveStatus::error) throw InvalidInput(name, solved.report.message);
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

bool is_proof(SolveStatus status) {
    return status == SolveStatus::optimal || status == SolveStatus::infeasible;
}

KnownOptimum optimum_by_both(const std::string& name, const SolvedScene& timed, const SolvedProgram& solved,
                             const LaneGraphProblem& problem, const LaneGraphModel& model) {
    const RldReport& exact = timed.report;
    const MilpReport& milp = solved.report;
    KnownOptimum known;
    known.best = exact.objective;
    known.bound = milp.bound;
    if (exact.bound) known.bound = std::max(known.bound.value_or(*exact.bound), *exact.bound);
    if (is_proof(exact.status)) known.proofs.push_back({"path-pair", timed.total_ms});
    if (is_proof(milp.status)) known.proofs.push_back({solved.engine, solved.time_ms});
    if (milp.status == SolveStatus::optimal) {
        const LaneGraph graph = model.decode(milp.point);
        const double value = objective(problem, graph);
        if (!is_feasible(problem, graph) || (is_proof(exact.status) && exact.status != milp.status) ||
            (exact.bound && value < *exact.bound - kSameObjective) ||
            (exact.objective && value > *exact.objective + kSameObjective))
            contradict(name, exact, milp);
        if (!known.best || value < *known.best) known.best = value;
    } else if (milp.status == SolveStatus::infeasible && exact.objective) {
        contradict(name, exact, milp);
    }
    if (known.best && known.bound) known.bound = std::min(*known.best, *known.bound);
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
constexpr const char* kIndex = "index.csv";
constexpr const char* kConeSets = "conelane.scenes.jsonl";
constexpr std::string_view kProgramEnding = ".mps.gz";

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

std::string cone_set_lines(std::span<const InstanceScene> sets) {
    std::string lines;
    for (const InstanceScene& set : sets) {
        Scene named = set.scene;
        named.id = set.name;
        lines += scene_line(named) + '\n';
    }
    return lines;
}

std::string mps_text(const Instance& instance) {
    std::ostringstream text;
    write_mps(text, instance.program, instance.name);
    return text.str();
}

std::string solution_lines(const Instance& instance) {
    const KnownOptimum& known = instance.optimum;
    if (known.is_infeasible()) return fmt::format("=inf= {}\n", instance.name);
    // Twelve digits: the engines agree on no more, and sums differ between machines after them.
    if (known.is_optimal()) return fmt::format("=opt= {} {:.12g}\n", instance.name, known.best.value());
    std::string lines;
    if (known.best) lines += fmt::format("=best= {} {:.12g}\n", instance.name, *known.best);
    if (known.bound && std::isfinite(*known.bound) && std::abs(*known.bound) < kInfinity)
        lines += fmt::format("=bestdual= {} {:.12g}\n", instance.name, *known.bound);
    return lines;
}

/// Nothing if there is no program.
std::optional<Instance> instance_of(const Scene& scene, const std::string& name, Formulation formulation,
                                    const RldParameters& parameters, double time_limit_ms,
                                    const SolvedScene& exact) {
    const Deadline no_deadline;
    const LimitedProblem limited = make_problem(scene, parameters, parts(formulation).extent, no_deadline);
    if (!limited.problem || limited.problem->edges.empty()) return std::nullopt;
    LaneGraphModel model(formulation);
    if (model.update(*limited.problem, no_deadline)) return std::nullopt;
    // CBC's full machinery is faster on the printed program and on a flow, `cbc` on the tight one.
    const MilpBackend& backend = formulation == Formulation::paper ? kCbcMain : kCbc;
    SolvedProgram solved = solve_and_separate(model, model.program(), backend, time_limit_ms);
    Instance instance{name, model.program(), optimum_by_both(name, exact, solved, *limited.problem, model)};
    if (instance.optimum.is_by_both()) {
        add_rows(instance.program, solved.added);
        return instance;
    }
    instance.has_flow = true;
    add_connecting_flow(instance.program, *limited.problem);
    if (is_proof(solved.report.status)) return instance;
    const std::optional<double> bound = solved.report.bound;
    solved = solve_and_separate(model, instance.program, kCbcMain, time_limit_ms);
    solved.engine += " all rows";
    if (bound) solved.report.bound = std::max(solved.report.bound.value_or(*bound), *bound);
    instance.optimum = optimum_by_both(name, exact, solved, *limited.problem, model);
    return instance;
}

std::string number(const std::optional<double>& value) {
    return value && std::isfinite(*value) && std::abs(*value) < kInfinity ? fmt::format("{:.12g}", *value)
                                                                          : std::string();
}

/// A feature of a cone set with parameters before it is solved: both formulations share it.
struct NamedFeature {
    std::string_view name;
    double value;
};

std::vector<NamedFeature> features_of_problem(const Scene& scene, const RldParameters& parameters) {
    const LaneGraphProblem problem = make_problem(scene, parameters);
    const auto share_of = [](double part, double whole) { return whole > 0.0 ? part / whole : 0.0; };
    const auto pairs_of = [](double count) { return count * (count - 1.0) / 2.0; };
    const auto cones = static_cast<double>(problem.cone_count);
    const auto conflicts = static_cast<double>(problem.conflicts.size());  // pairs of edges too close (7)
    std::vector<double> degree(problem.cone_count, 0.0);
    double edges = 0.0;  // candidates that (27) allows, and their costs
    double sum = 0.0;
    double min_cost = std::numeric_limits<double>::infinity();
    for (const ProblemEdge& edge : problem.edges) {
        if (edge.high_cost) continue;
        edges += 1.0;
        degree[edge.i] += 1.0;
        degree[edge.j] += 1.0;
        sum += edge.cost;
        min_cost = std::min(min_cost, edge.cost);
    }
    return {{"cones", cones},
            {"near_cones", static_cast<double>(std::ranges::count(problem.near, true))},
            {"edges", edges},
            {"edge_density", share_of(edges, pairs_of(cones))},
            {"turns", static_cast<double>(problem.turns.size())},
            {"allowed_turns",  // by (28)
             static_cast<double>(std::ranges::count(problem.turns, false, &ProblemTurn::high_cost))},
            {"conflicts", conflicts},
            {"conflict_density", share_of(conflicts, pairs_of(edges))},
            {"far_apart", static_cast<double>(problem.far_apart.size())},  // far cones that are no ends (17)
            {"mean_degree", share_of(2.0 * edges, cones)},
            {"max_degree", degree.empty() ? 0.0 : std::ranges::max(degree)},
            {"min_cost", edges > 0.0 ? min_cost : 0.0},
            {"mean_cost", share_of(sum, edges)}};
}

std::string index_head(std::span<const NamedFeature> features) {
    std::string line =
        "file,track,split,condition,false_positive_rate,range_m,nearest,costs,pairing,formulation,class,"
        "proved_by,first_by,first_ms,rows,best,bound,program_columns,program_rows,program_entries";
    for (const NamedFeature& feature : features) line += fmt::format(",{}", feature.name);
    return line + '\n';
}

std::string_view proved_by(const KnownOptimum& optimum) {
    if (optimum.proofs.empty()) return "none";
    if (optimum.proofs.size() > 1) return "both";
    return optimum.proofs.front().engine == "path-pair" ? "path-pair" : "cbc";
}

std::string index_line(const InstanceScene& set, const InstanceObjective& objective, Formulation formulation,
                       const Instance& instance, std::span<const NamedFeature> features) {
    const Proof* const first = instance.optimum.first();
    std::string line = fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}",
        instance.name + std::string(kProgramEnding), set.track,
        is_tuning_course(set.track) ? "tuning" : "held out", set.condition, number(set.false_positive_rate),
        number(set.range_m), set.nearest ? std::to_string(*set.nearest) : "all", objective.costs,
        to_string(objective.parameters.pairing), ending_of(formulation).substr(1),
        to_string(class_of(instance.optimum)), proved_by(instance.optimum),
        first == nullptr ? "" : first->engine, first == nullptr ? "" : fmt::format("{:.3f}", first->time_ms),
        instance.has_flow ? "flow" : "separated", number(instance.optimum.best),
        number(instance.optimum.bound), instance.program.columns.size(), instance.program.rows.size(),
        instance.program.entry_columns.size());
    for (const NamedFeature& feature : features) line += fmt::format(",{:.6g}", feature.value);
    return line + '\n';
}

}  // namespace

std::string InstanceObjective::suffix() const {
    std::string text;
    if (costs != "default") text += '_' + costs;
    if (parameters.pairing == Pairing::paper) text += "_paper";
    return text;
}

const Proof* KnownOptimum::first() const {
    const auto fastest = std::ranges::min_element(proofs, {}, &Proof::time_ms);
    return fastest == proofs.end() ? nullptr : &*fastest;
}

InstanceClass class_of(const KnownOptimum& optimum) {
    const Proof* const first = optimum.first();
    if (first == nullptr) return InstanceClass::open;
    return first->time_ms <= kEasy_ms ? InstanceClass::easy : InstanceClass::hard;
}

bool is_tuning_course(std::string_view track) {
    constexpr std::array<std::string_view, 6> kTuned{"pacsim_FSE22", "pacsim_FSG19",     "pacsim_FSO20",
                                                     "eufs_peanut",  "eufs_small_track", "eufs_comp_2021"};
    const std::vector<std::string> generated = generated_track_names();
    return track.starts_with("fsd_") || std::ranges::find(kTuned, track) != kTuned.end() ||
           std::ranges::find(generated, track.substr(0, track.find('@'))) != generated.end();
}

std::string_view to_string(InstanceClass instance_class) {
    constexpr std::array<std::string_view, 3> kNames{"easy", "hard", "open"};
    return kNames.at(static_cast<std::size_t>(instance_class));
}

std::vector<InstanceScene> instance_scenes(const InstanceOptions& options) {
    const std::vector<AnnotatedScene> scenes = make_scene_set(options.tracks, options.scenes).scenes;
    std::vector<std::pair<const AnnotatedScene*, std::optional<std::size_t>>> sets;
    for (const std::optional<std::size_t>& nearest : options.nearest) {
        std::vector<const AnnotatedScene*> of_size;
        for (const AnnotatedScene& scene : scenes) {
            if (!nearest || *nearest < scene.scene.cones.size()) of_size.push_back(&scene);
        }
        for (const AnnotatedScene* const scene : spread(of_size, options.limit))
            sets.emplace_back(scene, nearest);
    }
    std::ranges::stable_sort(sets, {}, [](const auto& set) { return set.first; });
    std::vector<InstanceScene> all;
    for (const auto& [annotated, nearest] : sets) {
        const Scene& scene = annotated->scene;
        all.push_back({name_of(scene.id, nearest), nearest ? nearest_ahead(scene, *nearest) : scene, nearest,
                       annotated->track, annotated->condition, annotated->false_positive_rate,
                       annotated->range_m});
    }
    return all;
}

std::string_view ending_of(Formulation formulation) {
    return formulation == Formulation::paper ? ".printed" : ".tight";
}

std::optional<Instance> make_instance(const Scene& scene, const std::string& name, Formulation formulation,
                                      const RldParameters& parameters, double time_limit_ms) {
    return instance_of(scene, name, formulation, parameters, time_limit_ms,
                       solve_exactly(scene, name, parameters, time_limit_ms));
}

InstanceCounts write_instances(const std::filesystem::path& folder, std::span<const InstanceScene> scenes,
                               const InstanceOptions& options, const std::function<void()>& advance) {
    std::set<std::string> names;
    for (const InstanceScene& set : scenes) {
        if (!names.insert(set.name).second)
            throw InvalidInput("--tracks",
                               fmt::format("two cone sets would have the file name '{}'", set.name));
    }
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    if (failure) throw InputError(folder, 0, "", "cannot be made: " + failure.message());
    const FolderLock lock(folder);
    remove_abandoned_files(folder);
    const std::vector<std::filesystem::path> earlier = listed_programs(folder);
    InstanceCounts counts;
    FilesTogether files;
    std::set<std::filesystem::path> written;
    std::string list;
    std::string solutions;
    std::string index;
    for (const InstanceScene& set : scenes) {
        for (const InstanceObjective& objective : options.objectives) {
            const RldParameters& parameters = objective.parameters;
            const std::string scene_name = set.name + objective.suffix();
            const SolvedScene exact = solve_exactly(set.scene, scene_name, parameters, options.time_limit_ms);
            const std::vector<NamedFeature> features = features_of_problem(set.scene, parameters);
            if (index.empty()) index = index_head(features);
            for (const Formulation formulation : kFormulations) {
                if (formulation == Formulation::paper && options.max_printed_cones &&
                    set.scene.cones.size() > *options.max_printed_cones) {
                    if (advance) advance();
                    continue;
                }
                const std::string name = scene_name + std::string(ending_of(formulation));
                const std::optional<Instance> instance =
                    instance_of(set.scene, name, formulation, parameters, options.time_limit_ms, exact);
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
                index += index_line(set, objective, formulation, *instance, features);
                ++counts.written;
                ++counts.of_class.at(static_cast<std::size_t>(class_of(instance->optimum)));
                counts.optimal += instance->optimum.is_optimal() ? 1 : 0;
                counts.infeasible += instance->optimum.is_infeasible() ? 1 : 0;
            }
        }
    }
    files.add(folder / kConeSets, cone_set_lines(scenes));
    files.add(folder / kIndex, index);
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
