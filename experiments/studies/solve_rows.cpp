#include "experiments/studies/solve_rows.hpp"

#include "conelane/check.hpp"
#include "conelane/invalid_input.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "evaluation/seeded_random.hpp"
#include "experiments/comparison/runner.hpp"
#include "experiments/options/shared_options.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/studies/machine.hpp"
#include "model/deadline.hpp"

#include <algorithm>
#include <cmath>
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
    Driver(const Backend& backend, std::size_t size, const SolveOptions& options)
        : backend_(backend), size_(size), options_(options), solver_(backend) {}

    void forget() { previous_.reset(); }
    [[nodiscard]] BackendSolver& solver() { return solver_; }

    SolveRow solve(const AnnotatedScene& annotated, const Scene& cones) {
        std::optional<LaneGraph> start;
        const Stopwatch watch;
        if (previous_) start = map_by_cone_id(previous_->first, previous_->second, cones);
        const double mapped_ms = watch.elapsed_ms();
        SolveRow row =
            solve(annotated, cones,
                  {.limits = {options_.time_limit_ms - mapped_ms}, .start = start ? &*start : nullptr});
        row.latency_ms += mapped_ms;
        return row;
    }

    /// From nothing, in another order of cones, rows and columns.
    SolveRow solve_permuted(const AnnotatedScene& annotated, const Scene& cones, std::size_t permutation) {
        const std::uint64_t seed = permutation_seed(annotated.scene.id, permutation, options_.seed);
        const Scene shuffled = with_shuffled_cones(cones, seed);
        SolveRow row = solve(annotated, shuffled, {.limits = {options_.time_limit_ms}, .seed = seed});
        row.permutation = permutation;
        return row;
    }

    /// What is known under each of the limits, without a start, and at the end of the row.
    void add_steps(SolveRow& row, const Scene& cones) {
        for (const double limit_ms : options_.gap_limits_ms) {
            if (limit_ms >= std::min(row.latency_ms, options_.time_limit_ms)) break;
            const SolveRow step = solve(*row.scene, cones, {.limits = {limit_ms}});
            if (step.status == SolveStatus::error) continue;
            const double time_ms = step.is_optimal() ? step.latency_ms : std::max(limit_ms, step.latency_ms);
            row.steps.push_back({time_ms, step.objective, step.bound});
        }
        std::ranges::sort(row.steps, {}, &Knowledge::time_ms);
        if (row.status != SolveStatus::error) row.steps.push_back({row.latency_ms, row.objective, row.bound});
    }

  private:
    SolveRow solve(const AnnotatedScene& annotated, const Scene& cones, const SolveArguments& arguments) {
        const double begin_ms = thread_cpu_ms();
        const auto [problem, report, solved_ms] =
            solve_scene(solver_.solver(), cones, options_.parameters, arguments);
        SolveRow row{.scene = &annotated,
                     .size = size_,
                     .cones = cones.cones.size(),
                     .backend = backend_,
                     .status = report.status,
                     .message = report.message,
                     .lane_graph = report.lane_graph,
                     .objective = report.objective,
                     .bound = report.bound,
                     .stopped_by = report.stopped_by,
                     .nodes = report.nodes,
                     .rounds = report.rounds,
                     .build_ms = report.build_ms,
                     .latency_ms = solved_ms,
                     .cpu_ms = thread_cpu_ms() - begin_ms,
                     .engine_ms = solver_.engine_ms()};
        row.edges =
            static_cast<std::size_t>(std::ranges::count(problem.edges, false, &ProblemEdge::high_cost));
        if (!report.lane_graph) return row;
        const Claim claim{row.is_optimal(), *report.objective, report.bound};
        const CheckReport checked = check(cones, options_.parameters, *report.lane_graph, claim);
        if (!checked.violations.empty()) {
            row.status = SolveStatus::error;
            row.message = "rejected by the checker: " + checked.violations.front();
        }
        if (backend_.warm_start) previous_.emplace(cones, *report.lane_graph);
        return row;
    }

    const Backend& backend_;
    std::size_t size_;
    const SolveOptions& options_;
    BackendSolver solver_;
    std::optional<std::pair<Scene, LaneGraph>> previous_;
};

std::vector<const AnnotatedScene*> scenes_of_size(std::span<const AnnotatedScene> scenes, std::size_t size,
                                                  const SolveOptions& options) {
    std::vector<const AnnotatedScene*> wanted;
    for (const AnnotatedScene& scene : scenes) {
        if (options.wanted ? options.wanted(scene, size) : has_cones(scene, size)) wanted.push_back(&scene);
    }
    return spread(wanted, options.limit);
}

void drive(const Backend& backend, std::size_t size, std::span<const AnnotatedScene> scenes,
           const SolveOptions& options, ReferenceProblem* reference, SolveResults& results) {
    const std::vector<const AnnotatedScene*> wanted = scenes_of_size(scenes, size, options);
    SolveBlock block{
        .size = size, .backend = backend.label(), .version = {}, .treatment = backend.treatment()};
    if (reference != nullptr) block.reference_ms = reference->mean_ms();
    const std::vector<std::size_t> starts = lap_starts(scenes);
    Progress progress(fmt::format("{} n={}", backend.label(), size_name(size)), wanted.size());
    Driver driver(backend, size, options);
    if (!wanted.empty()) {  // code is loaded before times are taken
        (void)driver.solve(*wanted.front(), cones_of(*wanted.front(), size));
        driver.forget();
    }
    const std::optional<PeakMemory> memory =
        reference == nullptr ? std::nullopt : std::optional<PeakMemory>(std::in_place);
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
    block.version = driver.solver().version();
    block.peak_bytes = driver.solver().end();
    if (!block.peak_bytes && memory) block.peak_bytes = memory->rise_bytes();
    results.blocks.push_back(std::move(block));
}

}  // namespace

std::string size_name(std::size_t size) {
    return size == kAllVisible ? "all" : std::to_string(size);
}

Scene cones_of(const AnnotatedScene& scene, std::size_t size) {
    return size == kAllVisible ? scene.scene : nearest_ahead(scene.scene, size);
}

bool has_cones(const AnnotatedScene& scene, std::size_t size) {
    return nearest_ahead(scene.scene, size).cones.size() == size;
}

double relative_gap(double objective, double optimum) {
    return std::max(0.0, objective - optimum) / std::max(1.0, std::abs(optimum));
}

FieldValue bound_value(const std::optional<double>& bound) {
    Json json = Json::object();
    if (bound) put_bound(json, *bound, "bound");
    return json.empty() ? std::nullopt : FieldValue(json["bound"]);
}

SolveResults solve_scenes(std::span<const AnnotatedScene> scenes, const SolveOptions& options) {
    for (const Backend& backend : options.backends) (void)backend.takes(1);
    SolveResults results;
    const PinnedThread pinned;
    std::optional<ReferenceProblem> reference;
    if (options.with_machine) reference.emplace();
    for (const std::size_t size : options.sizes) {
        for (const Backend& backend : options.backends) {
            if (!backend.takes(size)) continue;
            drive(backend, size, scenes, options, reference ? &*reference : nullptr, results);
        }
    }
    return results;
}

std::vector<SolveRow> solved_scenes(std::span<const AnnotatedScene> scenes, const SolveOptions& options) {
    std::vector<SolveRow> rows = solve_scenes(scenes, options).rows;
    for (const SolveRow& row : rows) {
        if (row.status == SolveStatus::error)
            throw InvalidInput(row.scene->scene.id, row.backend.solver + " failed: " + row.message);
    }
    return rows;
}

void mark_refuted_claims(std::span<SolveRow> rows) {
    using SizeAndScene = std::pair<std::size_t, const AnnotatedScene*>;
    std::map<SizeAndScene, const SolveRow*> best;
    for (const SolveRow& row : rows) {
        if (!row.objective || row.status == SolveStatus::error) continue;
        const SolveRow*& known = best[{row.size, row.scene}];
        if (known == nullptr || *row.objective < *known->objective) known = &row;
    }
    for (SolveRow& row : rows) {
        const auto known = best.find({row.size, row.scene});
        if (row.status == SolveStatus::error || known == best.end()) continue;
        const double least = *known->second->objective;
        const double most = least + kObjectiveTolerance * std::max(1.0, std::abs(least));
        const std::string other =
            fmt::format(" where {} has a lane graph of {:.9g}", known->second->backend.label(), least);
        if (row.is_infeasible()) {
            row.message = "claims that there is no lane graph" + other;
        } else if (row.is_optimal() && *row.objective > most) {
            row.message = fmt::format("claims the optimum {:.9g}", *row.objective) + other;
        } else if (row.bound && *row.bound > most) {
            row.message = fmt::format("claims the bound {:.9g}", *row.bound) + other;
        } else {
            continue;
        }
        row.refuted = true;
    }
}

AnswerErrors errors_among(std::span<const SolveRow> rows) {
    AnswerErrors errors;
    for (const SolveRow& row : rows) {
        const std::string backend = fmt::format("{} n={}", row.backend.label(), size_name(row.size));
        if (row.status == SolveStatus::error || row.refuted) {
            errors.add_error(backend, row.scene->scene.id, row.message);
        } else {
            errors.add_answer(backend);
        }
    }
    return errors;
}

}  // namespace conelane::experiments
