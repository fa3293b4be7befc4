// Times of the stages of CLC from scene to lane: the search graph, the enumeration with and without features
// (per iteration), the ranking (per candidate), and a whole detection. The scenes of benchmark_scenes take
// turns.
//
// Times of the stages of RLD from scene to program by cone-set size: making the problem, building the
// program, and updating it; `conelane study backends` has whole solves. Scenes are of generated tracks with
// 20 % false positives, or those of the file that the environment variable CONELANE_SCENES names. One
// iteration is one scene; the scenes take turns.

#include "experiments/benchmarks/benchmark_scenes.hpp"
#include "graph_search/clc/clc_detector.hpp"
#include "model/lane_graph_model.hpp"

#include <benchmark/benchmark.h>

namespace conelane::experiments {
namespace {

const std::vector<Scene>& scenes() {
    static const std::vector<Scene> all = [] {
        std::vector<Scene> result;
        for (AnnotatedScene& scene : benchmark_scenes(0.3)) result.push_back(std::move(scene.scene));
        return result;
    }();
    return all;
}

/// Seconds for one of the counted things; the program prints it with a unit.
benchmark::Counter time_of_each(double count) {
    return {count, benchmark::Counter::kIsRate | benchmark::Counter::kInvert};
}

void build_search_graph(benchmark::State& state) {
    std::vector<std::vector<Point>> points;
    for (const Scene& scene : scenes()) {
        points.emplace_back();
        for (const Cone& cone : scene.cones) points.back().push_back(cone.position);
    }
    SearchGraph graph;
    std::size_t turn = 0;
    for ([[maybe_unused]] auto iteration : state) {
        graph.build(points[turn++ % points.size()], CandidateSearchOptions{}.d_max_m);
        benchmark::DoNotOptimize(graph.directed_edge_count());
    }
}
BENCHMARK(build_search_graph)->Name("build_search_graph/all_pairs");

void enumerate(benchmark::State& state, const CandidateSearchOptions& options, bool with_features) {
    CandidateSearch search(options);
    CandidateSearch::Request request;
    request.with_features = with_features;
    double iterations = 0.0;
    std::size_t turn = 0;
    for ([[maybe_unused]] auto iteration : state) {
        iterations += static_cast<double>(search.run(scenes()[turn++ % scenes().size()], request).iterations);
    }
    state.counters["each_iteration"] = time_of_each(iterations);
}
BENCHMARK_CAPTURE(enumerate, paper, CandidateSearchOptions{}, false);
BENCHMARK_CAPTURE(enumerate, extended, extended_search_options(), false);
BENCHMARK_CAPTURE(enumerate, extended_with_features, extended_search_options(), true);

void rank(benchmark::State& state, const ClcOptions& options) {
    CandidateSearch search(options);
    CandidateSearch::Request request;
    request.with_features = true;
    std::vector<LaneFeatures> candidates;
    for (const Scene& scene : scenes()) {
        (void)search.run(scene, request);
        const std::span<const LaneFeatures> found = std::as_const(search).pairs().features();
        candidates.insert(candidates.end(), found.begin(), found.end());
        if (candidates.size() > 5000) break;
    }
    std::vector<double> scores(candidates.size());
    for ([[maybe_unused]] auto iteration : state) {
        options.ranking->score(candidates, scores);
        benchmark::DoNotOptimize(scores.data());
    }
    state.counters["each_candidate"] =
        time_of_each(static_cast<double>(candidates.size()) * static_cast<double>(state.iterations()));
}
BENCHMARK_CAPTURE(rank, paper, paper_clc_options());
BENCHMARK_CAPTURE(rank, extended, extended_clc_options());

void detect(benchmark::State& state, const ClcOptions& options) {
    const auto detector = make_clc_detector(options);
    std::size_t turn = 0;
    for ([[maybe_unused]] auto iteration : state) {
        LaneAnswer answer = detector->detect(scenes()[turn++ % scenes().size()],
                                             {.time_limit_ms = std::numeric_limits<double>::infinity()});
        benchmark::DoNotOptimize(answer);
    }
}
BENCHMARK_CAPTURE(detect, paper, paper_clc_options())->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(detect, extended, extended_clc_options())->Unit(benchmark::kMicrosecond);

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
