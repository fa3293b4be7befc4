// Times of the stages of CLC from scene to lane: the search graph, the enumeration with and without features
// (per iteration), the ranking (per candidate), and a whole detection. The scenes of benchmark_scenes take
// turns.

#include "experiments/benchmarks/benchmark_scenes.hpp"
#include "graph_search/clc/candidate_search.hpp"
#include "graph_search/clc/clc_detector.hpp"
#include "graph_search/shared/search_graph.hpp"

#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

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

}  // namespace
}  // namespace conelane::experiments
