#include "experiments/studies/backends.hpp"

#include "conelane/check.hpp"
#include "conelane/invalid_input.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/provenance.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "evaluation/seeded_random.hpp"
#include "experiments/comparison/pinning.hpp"
#include "experiments/comparison/runner.hpp"
#include "experiments/options/cone_set_sizes.hpp"
#include "experiments/options/whole_number.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/studies/aslib.hpp"
#include "experiments/studies/backend_measures.hpp"
#include "experiments/studies/cone_sets.hpp"
#include "experiments/studies/peak_memory.hpp"
#include "experiments/studies/reference_problem.hpp"
#include "experiments/studies/study.hpp"
#include "experiments/studies/study_options.hpp"
#include "experiments/studies/text_table.hpp"
#include "model/deadline.hpp"
#include "solvers/registry.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

/// The seed of a permutation, of a scene; never 0.
std::uint64_t permutation_seed(const std::string& scene, std::size_t permutation, std::uint64_t seed) {
    boost::random::mt19937_64 random = generator_of("permutation of " + scene, seed + 1000 * permutation);
    return random() | 1U;
}

Scene with_shuffled_cones(Scene scene, std::uint64_t seed) {
    boost::random::mt19937_64 random = generator_of("cones", seed);
    shuffle(scene.cones, random);
    return scene;
}

/// A backend along a lap.
class Driver {
  public:
    Driver(const Backend& backend, const BackendOptions& options)
        : backend_(backend), options_(options), solver_(backend) {}

    void forget() { previous_.reset(); }
    [[nodiscard]] BackendSolver& solver() { return solver_; }

    BackendRow solve(const AnnotatedScene& annotated, const Scene& cones) {
        std::optional<LaneGraph> start;
        const Stopwatch watch;
        if (previous_) start = map_by_cone_id(previous_->first, previous_->second, cones);
        const double mapped_ms = watch.elapsed_ms();
        BackendRow row =
            solve(annotated, cones,
                  {.limits = {options_.time_limit_ms - mapped_ms}, .start = start ? &*start : nullptr});
        row.latency_ms += mapped_ms;
        return row;
    }

    /// From nothing, in another order of cones, rows and columns.
    BackendRow solve_permuted(const AnnotatedScene& annotated, const Scene& cones, std::size_t permutation) {
        const std::uint64_t seed = permutation_seed(annotated.scene.id, permutation, options_.seed);
        const Scene shuffled = with_shuffled_cones(cones, seed);
        BackendRow row = solve(annotated, shuffled, {.limits = {options_.time_limit_ms}, .seed = seed});
        row.permutation = permutation;
        return row;
    }

    /// What is known under each of the limits, without a start, and at the end of the row.
    void add_steps(BackendRow& row, const Scene& cones) {
        for (const double limit_ms : options_.gap_limits_ms) {
            if (limit_ms >= std::min(row.latency_ms, options_.time_limit_ms)) break;
            const BackendRow step = solve(*row.scene, cones, {.limits = {limit_ms}});
            if (step.status == SolveStatus::error) continue;
            const bool proven = step.status == SolveStatus::optimal;
            row.steps.push_back(
                {proven ? step.latency_ms : std::max(limit_ms, step.latency_ms), step.objective, step.bound});
        }
        std::ranges::sort(row.steps, {}, &Knowledge::time_ms);
        if (row.status != SolveStatus::error) row.steps.push_back({row.latency_ms, row.objective, row.bound});
    }

  private:
    BackendRow solve(const AnnotatedScene& annotated, const Scene& cones, const SolveArguments& arguments) {
        const auto [problem, report, solved_ms] =
            solve_scene(solver_.solver(), cones, options_.parameters, arguments);
        BackendRow row{.scene = &annotated,
                       .cones = cones.cones.size(),
                       .backend = backend_,
                       .status = report.status,
                       .message = report.message,
                       .objective = report.objective,
                       .nodes = report.nodes,
                       .latency_ms = solved_ms,
                       .bound = report.bound,
                       .engine_ms = solver_.engine_ms(),
                       .rounds = report.rounds,
                       .stopped_by = report.stopped_by};
        if (!report.lane_graph) return row;
        const Claim claim{report.status == SolveStatus::optimal, *report.objective, report.bound};
        const CheckReport checked = check(cones, options_.parameters, *report.lane_graph, claim);
        if (!checked.violations.empty()) {
            row.status = SolveStatus::error;
            row.message = "rejected by the checker: " + checked.violations.front();
        }
        if (backend_.warm_start) previous_.emplace(cones, *report.lane_graph);
        return row;
    }

    const Backend& backend_;
    const BackendOptions& options_;
    BackendSolver solver_;
    std::optional<std::pair<Scene, LaneGraph>> previous_;
};

/// Whether the solver of the backend takes the cone sets of a size.
bool takes(const Backend& backend, std::size_t size) {
    return backend.takes(size == kAllVisible ? std::numeric_limits<std::size_t>::max() : size);
}

Scene cones_of(const AnnotatedScene& scene, std::size_t size) {
    return size == kAllVisible ? scene.scene : nearest_ahead(scene.scene, size);
}

/// The scenes with enough cones, lap by lap.
void drive(const Backend& backend, std::size_t size, std::span<const AnnotatedScene> scenes,
           const BackendOptions& options, ReferenceProblem& reference, BackendResults& results) {
    const std::vector<const AnnotatedScene*> wanted =
        scenes_of_size(scenes, size, options.limit, [](const AnnotatedScene&) { return true; });
    BackendBlock block{size, backend.label(), {}, {}, reference.mean_ms()};
    const std::vector<std::size_t> starts = lap_starts(scenes);
    Progress progress(fmt::format("{} n={}", backend.label(), size_name(size)), wanted.size());
    Driver driver(backend, options);
    if (!wanted.empty()) {  // code is loaded before times are taken
        (void)driver.solve(*wanted.front(), cones_of(*wanted.front(), size));
        driver.forget();
    }
    const PeakMemory memory;
    const std::size_t first_row = results.rows.size();
    std::size_t lap = 0;
    for (const AnnotatedScene* const scene : wanted) {
        const auto place = static_cast<std::size_t>(scene - scenes.data());
        for (; lap < starts.size() && place >= starts[lap]; ++lap) driver.forget();
        const Scene cones = cones_of(*scene, size);
        results.rows.push_back(driver.solve(*scene, cones));
        if (!backend.warm_start) {
            driver.add_steps(results.rows.back(), cones);
            for (std::size_t k = 1; k <= options.permutations; ++k)
                results.rows.push_back(driver.solve_permuted(*scene, cones, k));
        }
        progress.advance();
    }
    for (std::size_t row = first_row; row < results.rows.size(); ++row) results.rows[row].size = size;
    block.version = driver.solver().version();
    block.peak_bytes = driver.solver().end();
    if (!block.peak_bytes) block.peak_bytes = memory.rise_bytes();
    results.blocks.push_back(std::move(block));
}

/// Sums over the rows of one size and backend; errors and refuted claims in every order, all else unshuffled.
struct Sums {
    std::size_t optimal = 0, infeasible = 0, unproven = 0, errors = 0, refuted = 0;
    double nodes = 0.0;
    std::vector<double> latencies_ms;

    void add(const BackendRow& row) {
        const bool is_error = row.status == SolveStatus::error;
        refuted += row.refuted ? 1 : 0;
        errors += is_error && !row.refuted ? 1 : 0;
        if (row.permutation > 0) return;
        latencies_ms.push_back(row.latency_ms);
        nodes += static_cast<double>(row.nodes);
        if (row.refuted || is_error) return;
        std::size_t& outcome = row.status == SolveStatus::optimal      ? optimal
                               : row.status == SolveStatus::infeasible ? infeasible
                                                                       : unproven;
        ++outcome;
    }
};

nlohmann::ordered_json to_json(const BackendRow& row) {
    nlohmann::ordered_json json{{"scene", row.scene->scene.id},
                                {"track", row.scene->track},
                                {"nearest", row.size},
                                {"cones", row.cones},
                                {"backend", row.backend.label()},
                                {"status", row.refuted ? "error" : to_string(row.status)}};
    if (!row.scene->condition.empty()) json["condition"] = row.scene->condition;
    if (row.permutation > 0) json["permutation"] = row.permutation;
    if (!row.message.empty()) json["message"] = row.message;
    if (row.refuted) json["refuted"] = true;
    if (row.objective) json["objective"] = *row.objective;
    if (row.bound) put_bound(json, *row.bound, "bound");
    json["nodes"] = row.nodes;
    json["rounds"] = row.rounds;
    json["latency_ms"] = row.latency_ms;
    if (row.engine_ms) json["engine_ms"] = *row.engine_ms;
    for (const Knowledge& step : row.steps) {
        nlohmann::ordered_json known{{"time_ms", step.time_ms}};
        if (step.objective) known["objective"] = *step.objective;
        if (step.bound) put_bound(known, *step.bound, "bound");
        json["steps"].push_back(known);
    }
    return json;
}

nlohmann::ordered_json to_json(const BackendBlock& block) {
    nlohmann::ordered_json json{{"row", "block"},
                                {"nearest", block.size},
                                {"backend", block.backend},
                                {"version", block.version},
                                {"reference_ms", block.reference_ms}};
    if (block.peak_bytes) json["peak_bytes"] = *block.peak_bytes;
    return json;
}

class BackendsStudy : public Study {
  public:
    BackendsStudy()
        : Study(
              {"backends", "how fast is every exact solver on the same cone sets, and do all agree?",
               "Scene after scene in travel order, one thread, pinned; the time is from the scene in memory "
               "to the lane graph in memory, of a program from outside with files and pipes. Every lane "
               "graph "
               "passes the independent checker or counts as an error; a claim that another backend's lane "
               "graph refutes is one too. A warm start is the last lane graph of the lap, its cones found "
               "again by id. Between blocks, a size of a backend each, a reference problem is timed. "
               "Measures: docs/measures.md."}) {}

    void add_options(CLI::App& command) override {
        add_input_options(command, input_);
        command
            .add_option("--solvers", solvers_,
                        "exact solvers: SOLVER or SOLVER/FORMULATION, separated by commas; all for every "
                        "solver; or exec:NAME=COMMAND, a program from outside, in an argument of its own")
            ->capture_default_str();
        command
            .add_option("--formulations", formulations_,
                        "formulations for solvers that use one and do not name one")
            ->delimiter(',')
            ->check(CLI::IsMember({"tight", "paper"}))
            ->capture_default_str();
        command
            .add_option("--sizes", sizes_, "cones of a scene, the nearest ahead; `all` for all visible cones")
            ->delimiter(',')
            ->capture_default_str();
        command
            .add_option_function<std::size_t>(
                "--limit", [this](std::size_t count) { options_.limit = count; },
                "scenes of each size at most, evenly spread")
            ->check(whole_number(1, 1'000'000));
        command.add_flag("--warm-start", warm_start_,
                         "each also from the lane graph of the scene before, its cones found again by id");
        command.add_flag("--all-rows", all_rows_,
                         "each program from outside also on files with all rows, asked once");
        command
            .add_option("--permutations", options_.permutations,
                        "number of additional runs of each scene without a start, with cones, rows and "
                        "columns in other orders")
            ->check(whole_number(0, 1000))
            ->capture_default_str();
        command.add_option("--seed", options_.seed, "of the permutations")->capture_default_str();
        command
            .add_option(
                "--gap-limits", options_.gap_limits_ms,
                "time limits [ms], ascending: each scene is solved again under each, for the gap over time")
            ->delimiter(',')
            ->check(CLI::Range(0.1, 1e7));
        add_time_limit_option(command, options_.time_limit_ms);
        command.add_option("--aslib", aslib_,
                           "a folder for the runs and features of the instances as a scenario of ASlib");
    }

    StudyResult run() override {
        if (!std::ranges::is_sorted(options_.gap_limits_ms, std::less_equal()))
            throw InvalidInput("--gap-limits", "must be in ascending order");
        options_.parameters = input_.parameters.load();
        options_.backends = backends_asked_for();
        options_.sizes.clear();
        for (const std::optional<std::size_t>& size : cone_set_sizes("--sizes", sizes_))
            options_.sizes.push_back(size.value_or(kAllVisible));
        const std::vector<AnnotatedScene> scenes = read_scenes(input_.scenes);
        const BackendResults results = backend_results(scenes, options_);
        const BackendMeasures measures = measures_of(results.rows, options_.time_limit_ms);
        if (!aslib_.empty()) write_aslib_scenario(aslib_, results.rows, options_);
        StudyResult result = study_result(backend_table(results.rows) + left_out(), results.rows,
                                          [](const BackendRow& row) { return to_json(row); });
        result.errors = errors_among(results.rows);
        for (const BackendBlock& block : results.blocks) result.rows.push_back(to_json(block));
        for (nlohmann::ordered_json& row : to_json(measures)) result.rows.push_back(std::move(row));
        result.table += '\n' + measures_table(measures, results.blocks) + '\n' + machine(results);
        return result;
    }

  private:
    [[nodiscard]] std::vector<Formulation> formulations_asked_for() const {
        std::vector<Formulation> all;
        for (const std::string& name : formulations_)
            all.push_back(name == "paper" ? Formulation::paper : Formulation::tight);
        return all;
    }

    /// In the order of --solvers; with --all-rows and --warm-start, each solver once more for each option.
    [[nodiscard]] std::vector<Backend> backends_asked_for() const {
        std::vector<Backend> all;
        const auto add = [&](const Backend& backend, bool names_formulation) {
            std::vector<Backend> of_one{backend};
            if (!names_formulation && backend.uses_formulation()) {
                of_one.clear();
                for (const Formulation formulation : formulations_asked_for()) {
                    of_one.push_back(backend);
                    of_one.back().formulation = formulation;
                }
            }
            for (const Backend& one : of_one) {
                all.push_back(one);
                if (warm_start_) all.push_back(one), all.back().warm_start = true;
                if (all_rows_ && one.outside) all.push_back(one), all.back().all_rows = true;
            }
        };
        for (const std::string& solver : split_detectors(solvers_)) {
            if (solver == "all") {
                for (const Backend& backend : exact_backends()) add(backend, false);
                continue;
            }
            const std::string name = solver.substr(0, solver.find('='));
            add(backend_of(solver), name.find('/') != std::string::npos);
        }
        std::vector<std::string> labels;
        for (const Backend& backend : all) {
            if (std::ranges::find(labels, backend.label()) != labels.end())
                throw InvalidInput("--solvers", "two backends have the name " + backend.label());
            labels.push_back(backend.label());
        }
        return all;
    }

    /// A line for each backend and size that was not solved.
    [[nodiscard]] std::string left_out() const {
        std::string lines;
        for (const Backend& backend : options_.backends) {
            for (const std::size_t size : options_.sizes) {
                if (takes(backend, size)) continue;
                lines += fmt::format("{} takes at most {} cones: left out at n = {}\n", backend.label(),
                                     *find_rld_solver(backend.solver)->max_cones, size_name(size));
            }
        }
        return lines;
    }

    static std::string machine(const BackendResults& results) {
        std::vector<double> reference_ms;
        std::map<std::string, std::string> versions;
        for (const BackendBlock& block : results.blocks) {
            reference_ms.push_back(block.reference_ms);
            versions.emplace(block.backend, block.version);
        }
        std::string lines;
        for (const auto& [backend, version] : versions)
            lines += fmt::format("{}: {}\n", backend, version.empty() ? "version unknown" : version);
        lines += provenance().machine + '\n';
        if (reference_ms.empty()) return lines;
        return lines + fmt::format(
                           "reference problem: {:.3f} ms, median of {} blocks, coefficient of variation "
                           "{:.1f} %\n",
                           median(reference_ms), reference_ms.size(),
                           100.0 * coefficient_of_variation(reference_ms));
    }

    StudyInput input_;
    BackendOptions options_;
    std::vector<std::string> sizes_{"12", "30"};
    std::vector<std::string> solvers_{"all"};
    std::vector<std::string> formulations_{"tight"};
    bool warm_start_ = false;
    bool all_rows_ = false;
    std::string aslib_;
};

}  // namespace

BackendResults backend_results(std::span<const AnnotatedScene> scenes, const BackendOptions& options) {
    for (const Backend& backend : options.backends) (void)backend.takes(1);
    BackendResults results;
    const PinnedThread pinned;
    ReferenceProblem reference;
    for (const std::size_t size : options.sizes) {
        for (const Backend& backend : options.backends) {
            if (takes(backend, size)) drive(backend, size, scenes, options, reference, results);
        }
    }
    mark_refuted_claims(results.rows);
    return results;
}

std::vector<BackendRow> backend_rows(std::span<const AnnotatedScene> scenes, const BackendOptions& options) {
    return backend_results(scenes, options).rows;
}

void mark_refuted_claims(std::span<BackendRow> rows) {
    using SizeAndScene = std::pair<std::size_t, const AnnotatedScene*>;
    std::map<SizeAndScene, const BackendRow*> best;
    for (const BackendRow& row : rows) {
        if (!row.objective || row.status == SolveStatus::error) continue;
        const BackendRow*& known = best[{row.size, row.scene}];
        if (known == nullptr || *row.objective < *known->objective) known = &row;
    }
    for (BackendRow& row : rows) {
        const auto known = best.find({row.size, row.scene});
        if (row.status == SolveStatus::error || known == best.end()) continue;
        const double least = *known->second->objective;
        const double most = least + kObjectiveTolerance * std::max(1.0, std::abs(least));
        const std::string other =
            fmt::format(" where {} has a lane graph of {:.9g}", known->second->backend.label(), least);
        if (row.status == SolveStatus::infeasible) {
            row.message = "claims that there is no lane graph" + other;
        } else if (row.status == SolveStatus::optimal && *row.objective > most) {
            row.message = fmt::format("claims the optimum {:.9g}", *row.objective) + other;
        } else if (row.bound && *row.bound > most) {
            row.message = fmt::format("claims the bound {:.9g}", *row.bound) + other;
        } else {
            continue;
        }
        row.refuted = true;
    }
}

AnswerErrors errors_among(std::span<const BackendRow> rows) {
    AnswerErrors errors;
    for (const BackendRow& row : rows) {
        const std::string backend = fmt::format("{} n={}", row.backend.label(), size_name(row.size));
        if (row.status == SolveStatus::error || row.refuted) {
            errors.add_error(backend, row.scene->scene.id, row.message);
        } else {
            errors.add_answer(backend);
        }
    }
    return errors;
}

std::string backend_table(std::span<const BackendRow> rows) {
    std::vector<std::pair<std::size_t, std::string>> order;
    std::map<std::pair<std::size_t, std::string>, Sums> sums_of;
    for (const BackendRow& row : rows) {
        const std::pair key{row.size, row.backend.label()};
        if (!sums_of.contains(key)) order.push_back(key);
        sums_of[key].add(row);
    }
    TextTable table({{"n"},
                     {"backend", true},
                     {"scenes"},
                     {"optimal"},
                     {"infeasible"},
                     {"unproven"},
                     {"errors"},
                     {"refuted"},
                     {"nodes"},
                     {"median ms"},
                     {"p95 ms"},
                     {"max ms"}});
    for (const auto& key : order) {
        const Sums& sums = sums_of.at(key);
        const LatencyStatistics latency = latency_statistics(sums.latencies_ms);
        const std::size_t scenes = sums.latencies_ms.size();
        table.add({size_name(key.first), key.second, std::to_string(scenes), std::to_string(sums.optimal),
                   std::to_string(sums.infeasible), std::to_string(sums.unproven),
                   std::to_string(sums.errors), std::to_string(sums.refuted),
                   fixed(sums.nodes / static_cast<double>(scenes), 1), fixed(latency.median_ms, 2),
                   fixed(latency.p95_ms, 2), fixed(latency.max_ms, 2)});
    }
    return table.text();
}

std::string size_name(std::size_t size) {
    return size == kAllVisible ? "all" : std::to_string(size);
}

std::unique_ptr<Study> make_backends_study() {
    return std::make_unique<BackendsStudy>();
}

}  // namespace conelane::experiments
