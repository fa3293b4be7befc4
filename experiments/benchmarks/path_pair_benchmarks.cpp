// The benefit of each stage of path-pair.
//
//   ablation/STAGE/N   solves with one stage switched off, on cone sets of N (0: all visible), at most 50 ms
//                      each; counters: share proven in time, nodes a scene
//   scene/N            from a scene of the N nearest cones to the answer, with making the problem, limit
//                      50 ms; the scenes take turns; counters: median and p95 over the scenes of the median
//                      of nine solves each
//
//   verification/N     the check that every answer passes, on the best lane graph found in 50 ms; counter:
//                      mean time a scene
//
// Scenes are of generated tracks with 30 % false positives, or those of the file that the environment
// variable CONELANE_SCENES names.

#include "conelane/solve_scene.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "experiments/benchmarks/benchmark_scenes.hpp"
#include "model/answer_verification.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"

#include <benchmark/benchmark.h>

namespace conelane::experiments {
namespace {

constexpr double kTimeLimit_ms = 50.0;
constexpr std::int64_t kPasses = 9;

struct Ablation {
    const char* name;
    PathPairOptions options;
};

std::vector<Ablation> ablations() {
    std::vector<Ablation> all{{"everything", {}}};
    all.push_back({"no_fixing", {.fix_arcs = false}});
    all.push_back({"no_cliques", {.clique_multipliers = false}});
    all.push_back({"no_completion", {.complete_walks = false}});
    all.push_back({"no_fronts", {.search_frontiers = false}});
    all.push_back({"no_dominated_edges", {.drop_dominated_edges = false}});
    all.push_back({"no_ascent", {.root_steps = 1, .node_steps = 1}});
    return all;
}

using Problems = std::vector<LaneGraphProblem>;

Problems problems_of(const std::vector<AnnotatedScene>& scenes, std::size_t size) {
    Problems problems;
    for (const AnnotatedScene& annotated : scenes) {
        problems.push_back(
            make_problem(size == 0 ? annotated.scene : nearest_ahead(annotated.scene, size), {}));
    }
    return problems;
}

/// An iteration is one pass over all problems.
void run_ablation(benchmark::State& state, const PathPairOptions& options, const Problems& problems) {
    const std::unique_ptr<RldSolver> solver = make_path_pair_solver(options);
    std::int64_t solves = 0;
    std::int64_t proven = 0;
    std::int64_t nodes = 0;
    for (auto iteration : state) {
        static_cast<void>(iteration);
        for (const LaneGraphProblem& problem : problems) {
            const RldReport report = solver->solve(problem, {.limits = {kTimeLimit_ms}});
            ++solves;
            nodes += report.nodes;
            if (report.status == SolveStatus::optimal || report.status == SolveStatus::infeasible) ++proven;
        }
    }
    const auto count = static_cast<double>(solves);
    state.counters["proven"] = static_cast<double>(proven) / count;
    state.counters["nodes"] = static_cast<double>(nodes) / count;
    state.counters["per_scene"] =
        benchmark::Counter(count, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// An iteration is one pass over all scenes.
void run_scenes(benchmark::State& state, const std::vector<Scene>& scenes) {
    if (scenes.empty()) return state.SkipWithError("no scene has so many cones");
    const std::unique_ptr<RldSolver> solver = make_path_pair_solver();
    std::vector<std::vector<double>> times_us(scenes.size());
    for (auto iteration : state) {
        static_cast<void>(iteration);
        for (std::size_t i = 0; i < scenes.size(); ++i) {
            times_us[i].push_back(1e3 *
                                  solve_scene(*solver, scenes[i], {}, {.limits = {kTimeLimit_ms}}).total_ms);
        }
    }
    std::vector<double> medians_us;
    for (const std::vector<double>& times : times_us) medians_us.push_back(median(times));
    state.counters["median_us"] = median(medians_us);
    state.counters["p95_us"] = quantile(medians_us, 0.95);
    state.counters["scenes"] = static_cast<double>(scenes.size());
}

/// An iteration is one pass over all lane graphs.
void run_verification(benchmark::State& state, const Problems& problems) {
    const std::unique_ptr<RldSolver> solver = make_path_pair_solver();
    std::vector<std::pair<const LaneGraphProblem*, LaneGraph>> answers;
    for (const LaneGraphProblem& problem : problems) {
        const RldReport report = solver->solve(problem, {.limits = {kTimeLimit_ms}});
        if (report.lane_graph) answers.emplace_back(&problem, *report.lane_graph);
    }
    if (answers.empty()) return state.SkipWithError("no scene has a lane graph");
    std::int64_t verified = 0;
    for (auto iteration : state) {
        static_cast<void>(iteration);
        for (const auto& [problem, graph] : answers) {
            benchmark::DoNotOptimize(verify_answer(*problem, graph));
            ++verified;
        }
    }
    state.counters["per_scene"] = benchmark::Counter(
        static_cast<double>(verified), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void register_all(const SharedScenes& all) {
    for (const std::size_t size : std::array<std::size_t, 4>{12, 30, 60, 0}) {
        for (const Ablation& ablation : ablations()) {
            const std::string name = std::string("ablation/") + ablation.name + "/" + std::to_string(size);
            benchmark::RegisterBenchmark(name.c_str(),
                                         [=](benchmark::State& state) {
                                             run_ablation(state, ablation.options, problems_of(*all, size));
                                         })
                ->Unit(benchmark::kMillisecond)
                ->UseRealTime();
        }
    }
    for (const std::size_t size : std::array<std::size_t, 4>{12, 30, 60, 0}) {
        benchmark::RegisterBenchmark(
            ("verification/" + std::to_string(size)).c_str(),
            [=](benchmark::State& state) { run_verification(state, problems_of(*all, size)); })
            ->Unit(benchmark::kMicrosecond);
    }
    for (const std::size_t size : std::array<std::size_t, 4>{12, 30, 60, 120}) {
        benchmark::RegisterBenchmark(
            ("scene/" + std::to_string(size)).c_str(),
            [=](benchmark::State& state) { run_scenes(state, scenes_of_size(*all, size)); })
            ->Iterations(kPasses)
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime();
    }
}

}  // namespace
}  // namespace conelane::experiments

int main(int argument_count, char** arguments) {
    return conelane::experiments::run_benchmarks(argument_count, arguments, 0.3,
                                                 conelane::experiments::register_all);
}
