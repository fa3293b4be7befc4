#include "experiments/comparison/backends.hpp"

#include "experiments/comparison/pinning.hpp"
#include "experiments/comparison/runner.hpp"
#include "experiments/files/figure_file.hpp"
#include "experiments/progress.hpp"
#include "experiments/scoring/statistics.hpp"
#include "model/check.hpp"
#include "model/deadline.hpp"
#include "model/invalid_input.hpp"
#include "solvers/registry.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

constexpr double kAgreement = 1e-6;

const RldSolverEntry& entry_of(const Backend& backend) {
    const RldSolverEntry* entry = find_rld_solver(backend.solver);
    if (entry == nullptr) throw InvalidInput("solver", "there is no solver '" + backend.solver + "'");
    return *entry;
}

/// A backend along a lap.
class Driver {
  public:
    Driver(const Backend& backend, const BackendOptions& options)
        : backend_(backend), options_(options), solver_(entry_of(backend).make(backend.formulation)) {}

    void forget() { previous_.reset(); }

    BackendRow solve(const AnnotatedScene& annotated, const Scene& cones) {
        const Stopwatch watch;
        const Deadline deadline(options_.time_limit_ms);
        const LaneGraphProblem problem = make_problem(cones, options_.parameters, solver_->extent());
        std::optional<LaneGraph> start;
        if (previous_) start = map_by_cone_id(previous_->first, previous_->second, cones);
        const RldReport report =
            solver_->solve(problem, {deadline.remaining_ms()}, start ? &*start : nullptr);
        BackendRow row{&annotated,     cones.cones.size(), backend_,     report.status,
                       report.message, report.objective,   report.nodes, watch.elapsed_ms()};
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

}  // namespace

std::string Backend::label() const {
    const RldSolverEntry* entry = find_rld_solver(solver);
    std::string label = solver;
    if (entry != nullptr && entry->uses_formulation) label += fmt::format("/{}", to_string(formulation));
    return warm_start ? label + " warm" : label;
}

std::vector<Backend> exact_backends() {
    const std::array all{Backend{"path-pair"}, Backend{"glpk"}, Backend{"clp-bb"}, Backend{"cbc"},
                         Backend{"cbc-main", Formulation::paper}};
    std::vector<Backend> built;
    for (const Backend& backend : all) {
        if (find_rld_solver(backend.solver) != nullptr) built.push_back(backend);
    }
    return built;
}

std::vector<BackendRow> backend_rows(std::span<const AnnotatedScene> scenes, const BackendOptions& options) {
    for (const Backend& backend : options.backends) (void)entry_of(backend);
    std::vector<BackendRow> rows;
    const std::vector<std::size_t> starts = lap_starts(scenes);
    const PinnedThread pinned;
    for (const std::size_t size : options.sizes) {
        for (const Backend& backend : options.backends) {
            Progress progress(fmt::format("{} n={}", backend.label(), size), scenes.size());
            Driver driver(backend, options);
            bool is_loaded = false;
            for (std::size_t lap = 0; lap + 1 < starts.size(); ++lap) {
                driver.forget();
                for (const AnnotatedScene& scene :
                     scenes.subspan(starts[lap], starts[lap + 1] - starts[lap])) {
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
    }
    return rows;
}

std::string backend_table(std::span<const BackendRow> rows) {
    struct Sums {
        std::size_t optimal = 0, infeasible = 0, unproven = 0, errors = 0, differ = 0;
        double nodes = 0.0;
        std::vector<double> latencies_ms;
    };
    std::map<std::pair<std::size_t, const AnnotatedScene*>, double> lowest;
    for (const BackendRow& row : rows) {
        if (row.status != SolveStatus::optimal) continue;
        const auto [known, is_new] = lowest.try_emplace({row.cones, row.scene}, *row.objective);
        if (!is_new) known->second = std::min(known->second, *row.objective);
    }
    std::vector<std::pair<std::size_t, std::string>> order;
    std::map<std::pair<std::size_t, std::string>, Sums> sums_of;
    for (const BackendRow& row : rows) {
        const std::pair key{row.cones, row.backend.label()};
        if (!sums_of.contains(key)) order.push_back(key);
        Sums& sums = sums_of[key];
        sums.latencies_ms.push_back(row.latency_ms);
        sums.nodes += static_cast<double>(row.nodes);
        if (row.status == SolveStatus::optimal) {
            ++sums.optimal;
            if (*row.objective > lowest.at({row.cones, row.scene}) + kAgreement) ++sums.differ;
        } else if (row.status == SolveStatus::infeasible) {
            ++sums.infeasible;
        } else if (row.status == SolveStatus::error) {
            ++sums.errors;
        } else {
            ++sums.unproven;
        }
    }
    std::string table =
        fmt::format("{:>3} {:<20} {:>6} {:>8} {:>10} {:>8} {:>6} {:>6} {:>9} {:>9} {:>9} {:>9}\n", "n",
                    "backend", "scenes", "optimal", "infeasible", "unproven", "errors", "differ", "nodes",
                    "median ms", "p95 ms", "max ms");
    for (const auto& key : order) {
        const Sums& sums = sums_of.at(key);
        const LatencyStatistics latency = latency_statistics(sums.latencies_ms);
        const std::size_t scenes = sums.latencies_ms.size();
        table += fmt::format(
            "{:>3} {:<20} {:>6} {:>8} {:>10} {:>8} {:>6} {:>6} {:>9.1f} {:>9.3f} {:>9.3f} {:>9.3f}\n",
            key.first, key.second, scenes, sums.optimal, sums.infeasible, sums.unproven, sums.errors,
            sums.differ, sums.nodes / static_cast<double>(scenes), latency.median_ms, latency.p95_ms,
            latency.max_ms);
    }
    return table;
}

void write_backend_rows(const std::filesystem::path& file, std::span<const BackendRow> rows) {
    FigureFile output(file);
    for (const BackendRow& row : rows) {
        nlohmann::ordered_json json{{"scene", row.scene->scene.id},
                                    {"track", row.scene->track},
                                    {"nearest", row.cones},
                                    {"backend", row.backend.label()},
                                    {"status", to_string(row.status)}};
        if (!row.message.empty()) json["message"] = row.message;
        if (row.objective) json["objective"] = *row.objective;
        json["nodes"] = row.nodes;
        json["latency_ms"] = row.latency_ms;
        output.add(std::move(json));
    }
    output.commit();
}

}  // namespace conelane::experiments
