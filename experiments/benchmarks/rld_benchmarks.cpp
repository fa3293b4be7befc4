// Times of the stages from scene to program by cone-set size: making the problem, building the program, and
// updating it; `conelane study backends` has whole solves. Scenes are of generated tracks with 20 % false
// positives, or those of the file that the environment variable CONELANE_SCENES names. One iteration is one
// scene; the scenes take turns.

#include "evaluation/world/annotated_scene.hpp"
#include "experiments/benchmarks/benchmark_scenes.hpp"
#include "model/lane_graph_model.hpp"

#include <array>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

namespace conelane::experiments {
namespace {

constexpr std::array<std::int64_t, 6> kSizes{6, 9, 12, 16, 20, 30};

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

void register_stages(const SharedScenes& all, Formulation formulation, std::int64_t size) {
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

void register_all(const SharedScenes& all) {
    for (const Formulation formulation : {Formulation::tight, Formulation::paper}) {
        for (const std::int64_t size : kSizes) register_stages(all, formulation, size);
    }
}

}  // namespace
}  // namespace conelane::experiments

int main(int argument_count, char** arguments) {
    return conelane::experiments::run_benchmarks(argument_count, arguments, 0.2,
                                                 conelane::experiments::register_all);
}
