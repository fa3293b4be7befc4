// Times of the stages from scene to lane graph by cone-set size: making the problem, building the program,
// updating it, and a whole solve by each backend. Scenes are of generated tracks with 20 % false positives,
// or those of the file that the environment variable CONELANE_SCENES names. One iteration is one scene; the
// scenes take turns.

#include "evaluation/world/annotated_scene.hpp"
#include "experiments/benchmarks/benchmark_scenes.hpp"
#include "model/lane_graph_model.hpp"
#include "solvers/registry.hpp"

#include <array>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

namespace conelane::experiments {
namespace {

constexpr std::array<std::int64_t, 6> kSizes{6, 9, 12, 16, 20, 30};
/// Larger programs of the paper formulation take seconds.
constexpr std::int64_t kMaxPaperSize = 12;

std::vector<LaneGraphProblem> problems_of(const std::vector<Scene>& scenes, EdgeExtent extent) {
    std::vector<LaneGraphProblem> problems;
    for (const Scene& scene : scenes) problems.push_back(make_problem(scene, {}, extent));
    return problems;
}

/// Calls `step` with the index of the next scene in each iteration.
template <typename Step>
void take_turns(benchmark::State& state, std::size_t count, const Step& step) {
    if (count == 0) {
        state.SkipWithError("no scene has so many cones");
        return;
    }
    std::size_t next = 0;
    for (auto iteration : state) {
        static_cast<void>(iteration);
        step(next);
        next = (next + 1) % count;
    }
}

using Scenes = std::shared_ptr<const std::vector<AnnotatedScene>>;

void register_stages(const Scenes& all, Formulation formulation, std::int64_t size) {
    const std::string ending = "/" + std::string(to_string(formulation)) + "/" + std::to_string(size);
    const EdgeExtent extent = parts(formulation).extent;
    const auto cones = static_cast<std::size_t>(size);
    benchmark::RegisterBenchmark(("problem" + ending).c_str(), [=](benchmark::State& state) {
        const std::vector<Scene> scenes = scenes_of_size(*all, cones);
        take_turns(state, scenes.size(),
                   [&](std::size_t i) { benchmark::DoNotOptimize(make_problem(scenes[i], {}, extent)); });
    });
    benchmark::RegisterBenchmark(("build" + ending).c_str(), [=](benchmark::State& state) {
        const auto problems = problems_of(scenes_of_size(*all, cones), extent);
        take_turns(state, problems.size(), [&](std::size_t i) {
            const LaneGraphModel model(problems[i], formulation);
            benchmark::DoNotOptimize(model.program().rows.size());
        });
    });
    benchmark::RegisterBenchmark(("update" + ending).c_str(), [=](benchmark::State& state) {
        const auto problems = problems_of(scenes_of_size(*all, cones), extent);
        if (problems.empty()) return state.SkipWithError("no scene has so many cones");
        LaneGraphModel model(problems.front(), formulation);
        take_turns(state, problems.size(), [&](std::size_t i) {
            model.update(problems[i]);
            benchmark::DoNotOptimize(model.program().rows.size());
        });
    });
}

void register_solve(const Scenes& all, const RldSolverEntry& entry, Formulation formulation,
                    std::int64_t size) {
    std::string name = "solve/" + std::string(entry.name);
    if (entry.has(SolverTrait::uses_formulation)) name += "/" + std::string(to_string(formulation));
    const auto cones = static_cast<std::size_t>(size);
    benchmark::RegisterBenchmark((name + "/" + std::to_string(size)).c_str(), [=, &entry](
                                                                                  benchmark::State& state) {
        const std::vector<Scene> scenes = scenes_of_size(*all, cones);
        const auto solver = entry.make(formulation);
        take_turns(state, scenes.size(), [&](std::size_t i) {
            const auto problem = make_problem(scenes[i], {}, solver->extent());
            const RldReport report = solver->solve(problem, {});
            if (report.status == SolveStatus::error) state.SkipWithError(report.message.c_str());
        });
    })->UseRealTime();
}

void register_all(const Scenes& all) {
    for (const Formulation formulation : {Formulation::tight, Formulation::paper}) {
        for (const std::int64_t size : kSizes) register_stages(all, formulation, size);
    }
    for (const RldSolverEntry& entry : rld_solvers()) {
        for (const std::int64_t size : kSizes) {
            register_solve(all, entry, Formulation::tight, size);
            if (entry.has(SolverTrait::uses_formulation) && size <= kMaxPaperSize)
                register_solve(all, entry, Formulation::paper, size);
        }
    }
}

}  // namespace
}  // namespace conelane::experiments

int main(int argument_count, char** arguments) {
    benchmark::Initialize(&argument_count, arguments);
    if (benchmark::ReportUnrecognizedArguments(argument_count, arguments)) return 1;
    try {
        namespace experiments = conelane::experiments;
        experiments::register_all(std::make_shared<const std::vector<conelane::AnnotatedScene>>(
            experiments::benchmark_scenes(0.2)));
    } catch (const std::exception& failure) {
        std::cerr << "conelane_benchmarks: " << failure.what() << '\n';
        return 2;
    }
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
}
