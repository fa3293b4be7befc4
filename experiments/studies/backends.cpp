#include "experiments/studies/backends.hpp"

#include "conelane/check.hpp"
#include "conelane/invalid_input.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/scenes/scene_file.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "experiments/comparison/pinning.hpp"
#include "experiments/comparison/runner.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/studies/study.hpp"
#include "experiments/studies/study_options.hpp"
#include "experiments/studies/text_table.hpp"
#include "model/deadline.hpp"
#include "solvers/registry.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

const RldSolverEntry& entry_of(const Backend& backend) {
    const RldSolverEntry* entry = find_rld_solver(backend.solver);
    if (entry == nullptr) throw InvalidInput("--solvers", "there is no solver '" + backend.solver + "'");
    return *entry;
}

/// A backend along a lap.
class Driver {
  public:
    Driver(const Backend& backend, const BackendOptions& options)
        : backend_(backend), options_(options), solver_(entry_of(backend).make(backend.formulation)) {}

    void forget() { previous_.reset(); }

    BackendRow solve(const AnnotatedScene& annotated, const Scene& cones) {
        std::optional<LaneGraph> start;
        const Stopwatch watch;
        if (previous_) start = map_by_cone_id(previous_->first, previous_->second, cones);
        const double mapped_ms = watch.elapsed_ms();
        const auto [problem, report, solved_ms] =
            solve_scene(*solver_, cones, options_.parameters, {options_.time_limit_ms - mapped_ms},
                        start ? &*start : nullptr);
        BackendRow row{&annotated,     cones.cones.size(), backend_,     report.status,
                       report.message, report.objective,   report.nodes, mapped_ms + solved_ms};
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

  private:
    const Backend& backend_;
    const BackendOptions& options_;
    std::unique_ptr<RldSolver> solver_;
    std::optional<std::pair<Scene, LaneGraph>> previous_;
};

/// Whether the solver of the backend takes cone sets of this size.
bool takes(const Backend& backend, std::size_t size) {
    const RldSolverEntry& entry = entry_of(backend);
    return !entry.max_cones || size <= *entry.max_cones;
}

/// All scenes that have as many cones, lap by lap.
void drive(const Backend& backend, std::size_t size, std::span<const AnnotatedScene> scenes,
           const BackendOptions& options, std::vector<BackendRow>& rows) {
    const std::vector<std::size_t> starts = lap_starts(scenes);
    Progress progress(fmt::format("{} n={}", backend.label(), size), scenes.size());
    Driver driver(backend, options);
    bool is_loaded = false;
    for (std::size_t lap = 0; lap + 1 < starts.size(); ++lap) {
        driver.forget();
        for (const AnnotatedScene& scene : scenes.subspan(starts[lap], starts[lap + 1] - starts[lap])) {
            const Scene cones = nearest_ahead(scene.scene, size);
            progress.advance();
            if (cones.cones.size() < size) continue;
            if (!std::exchange(is_loaded, true)) {  // code is loaded outside of any time
                (void)driver.solve(scene, cones);
                driver.forget();
            }
            rows.push_back(driver.solve(scene, cones));
        }
    }
}

using SizeAndScene = std::pair<std::size_t, const AnnotatedScene*>;

/// The lowest optimum that any backend proved.
std::map<SizeAndScene, double> lowest_optima(std::span<const BackendRow> rows) {
    std::map<SizeAndScene, double> lowest;
    for (const BackendRow& row : rows) {
        if (row.status != SolveStatus::optimal) continue;
        const auto [known, is_new] = lowest.try_emplace({row.cones, row.scene}, *row.objective);
        if (!is_new) known->second = std::min(known->second, *row.objective);
    }
    return lowest;
}

/// What the rows of one size and backend add up to.
struct Sums {
    std::size_t optimal = 0, infeasible = 0, unproven = 0, errors = 0, differ = 0;
    double nodes = 0.0;
    std::vector<double> latencies_ms;

    void add(const BackendRow& row, const std::map<SizeAndScene, double>& lowest) {
        latencies_ms.push_back(row.latency_ms);
        nodes += static_cast<double>(row.nodes);
        if (row.status == SolveStatus::optimal) {
            ++optimal;
            if (*row.objective > lowest.at({row.cones, row.scene}) + kObjectiveTolerance) ++differ;
        } else if (row.status == SolveStatus::infeasible) {
            ++infeasible;
        } else if (row.status == SolveStatus::error) {
            ++errors;
        } else {
            ++unproven;
        }
    }
};

nlohmann::ordered_json to_json(const BackendRow& row) {
    nlohmann::ordered_json json{{"scene", row.scene->scene.id},
                                {"track", row.scene->track},
                                {"nearest", row.cones},
                                {"backend", row.backend.label()},
                                {"status", to_string(row.status)}};
    if (!row.message.empty()) json["message"] = row.message;
    if (row.objective) json["objective"] = *row.objective;
    json["nodes"] = row.nodes;
    json["latency_ms"] = row.latency_ms;
    return json;
}

class BackendsStudy : public Study {
  public:
    BackendsStudy()
        : Study(
              {"backends", "how fast is every exact solver on the same cone sets, and do all agree?",
               "Scene after scene in travel order, one thread, pinned; the time is from the scene in memory "
               "to the lane graph in memory. Every lane graph passes the independent checker or counts as "
               "an error. A warm start is the last lane graph of the lap, its cones found again by id."}) {}

    void add_options(CLI::App& command) override {
        add_input_options(command, input_);
        command
            .add_option(
                "--solvers", solvers_,
                "exact ones: SOLVER or SOLVER/FORMULATION; all for every one, on the tight formulation")
            ->delimiter(',')
            ->capture_default_str();
        add_sizes_option(command, options_.sizes);
        command.add_flag("--warm-start", warm_start_,
                         "each also from the lane graph of the scene before, its cones found again by id");
        add_time_limit_option(command, options_.time_limit_ms);
    }

    StudyResult run() override {
        options_.parameters = input_.parameters.load();
        options_.backends = backends_asked_for();
        const std::vector<AnnotatedScene> scenes = read_scenes(input_.scenes);
        const std::vector<BackendRow> rows = backend_rows(scenes, options_);
        StudyResult result = study_result(backend_table(rows) + left_out(), rows, to_json);
        result.errors = errors_among(rows);
        return result;
    }

  private:
    /// In the order of --solvers, with --warm-start each a second time.
    [[nodiscard]] std::vector<Backend> backends_asked_for() const {
        std::vector<Backend> cold;
        for (const std::string& solver : solvers_) {
            if (solver == "all") {
                std::ranges::move(exact_backends(), std::back_inserter(cold));
            } else {
                cold.push_back(backend_of(solver));
            }
        }
        if (!warm_start_) return cold;
        std::vector<Backend> both;
        for (const Backend& backend : cold) {
            both.push_back(backend);
            both.push_back(backend);
            both.back().warm_start = true;
        }
        return both;
    }

    /// A line for each backend and size that was not solved.
    [[nodiscard]] std::string left_out() const {
        std::string lines;
        for (const Backend& backend : options_.backends) {
            for (const std::size_t size : options_.sizes) {
                if (takes(backend, size)) continue;
                lines += fmt::format("{} takes at most {} cones: left out at n = {}\n", backend.label(),
                                     *entry_of(backend).max_cones, size);
            }
        }
        return lines;
    }

    StudyInput input_;
    BackendOptions options_;
    std::vector<std::string> solvers_{"all"};
    bool warm_start_ = false;
};

}  // namespace

std::string Backend::label() const {
    const RldSolverEntry* entry = find_rld_solver(solver);
    std::string label = solver;
    if (entry != nullptr && entry->uses_formulation) label += fmt::format("/{}", to_string(formulation));
    return warm_start ? label + " warm" : label;
}

std::vector<Backend> exact_backends() {
    std::vector<Backend> backends;
    for (const RldSolverEntry& entry : rld_solvers()) {
        if (entry.exact) backends.push_back({std::string(entry.name)});
    }
    return backends;
}

Backend backend_of(std::string_view name) {
    const std::size_t slash = std::min(name.find('/'), name.size());
    Backend backend{std::string(name.substr(0, slash))};
    const RldSolverEntry& entry = entry_of(backend);
    if (!entry.exact) throw InvalidInput("--solvers", "'" + backend.solver + "' proves no optimum");
    if (slash == name.size()) return backend;
    for (const Formulation formulation : {Formulation::tight, Formulation::paper}) {
        if (!entry.uses_formulation || to_string(formulation) != name.substr(slash + 1)) continue;
        backend.formulation = formulation;
        return backend;
    }
    throw InvalidInput("--solvers",
                       fmt::format("'{}' has no formulation '{}'", backend.solver, name.substr(slash + 1)));
}

std::vector<BackendRow> backend_rows(std::span<const AnnotatedScene> scenes, const BackendOptions& options) {
    for (const Backend& backend : options.backends) (void)entry_of(backend);
    std::vector<BackendRow> rows;
    const PinnedThread pinned;
    for (const std::size_t size : options.sizes) {
        for (const Backend& backend : options.backends) {
            if (takes(backend, size)) drive(backend, size, scenes, options, rows);
        }
    }
    return rows;
}

AnswerErrors errors_among(std::span<const BackendRow> rows) {
    AnswerErrors errors;
    for (const BackendRow& row : rows) {
        const std::string backend = fmt::format("{} n={}", row.backend.label(), row.cones);
        if (row.status == SolveStatus::error) {
            errors.add_error(backend, row.scene->scene.id, row.message);
        } else {
            errors.add_answer(backend);
        }
    }
    return errors;
}

std::string backend_table(std::span<const BackendRow> rows) {
    const std::map<SizeAndScene, double> lowest = lowest_optima(rows);
    std::vector<std::pair<std::size_t, std::string>> order;
    std::map<std::pair<std::size_t, std::string>, Sums> sums_of;
    for (const BackendRow& row : rows) {
        const std::pair key{row.cones, row.backend.label()};
        if (!sums_of.contains(key)) order.push_back(key);
        sums_of[key].add(row, lowest);
    }
    TextTable table({{"n"},
                     {"backend", true},
                     {"scenes"},
                     {"optimal"},
                     {"infeasible"},
                     {"unproven"},
                     {"errors"},
                     {"differ"},
                     {"nodes"},
                     {"median ms"},
                     {"p95 ms"},
                     {"max ms"}});
    for (const auto& key : order) {
        const Sums& sums = sums_of.at(key);
        const LatencyStatistics latency = latency_statistics(sums.latencies_ms);
        const std::size_t scenes = sums.latencies_ms.size();
        table.add({std::to_string(key.first), key.second, std::to_string(scenes),
                   std::to_string(sums.optimal), std::to_string(sums.infeasible),
                   std::to_string(sums.unproven), std::to_string(sums.errors), std::to_string(sums.differ),
                   fixed(sums.nodes / static_cast<double>(scenes), 1), fixed(latency.median_ms, 3),
                   fixed(latency.p95_ms, 3), fixed(latency.max_ms, 3)});
    }
    return table.text();
}

std::unique_ptr<Study> make_backends_study() {
    return std::make_unique<BackendsStudy>();
}

}  // namespace conelane::experiments
