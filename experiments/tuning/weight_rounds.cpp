#include "experiments/tuning/weight_rounds.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/proofs/answer_check.hpp"
#include "evaluation/world/ground_truth.hpp"
#include "experiments/tuning/weight_fit.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace conelane::experiments {
namespace {

/// Parameter sets besides the weights themselves: in the first round, only the start is known.
constexpr std::size_t kDrawnFirst = 5;
constexpr std::size_t kDrawnLater = 2;
/// Standard deviation of a drawn weight's logarithm.
constexpr double kSpreadFirst = 0.5;
constexpr double kSpreadLater = 0.25;

/// The knowledge about one scene from all rounds.
struct KnownScene {
    const AnnotatedScene* annotated;
    std::vector<LaneGraph> graphs;
    RatedGraphs rated;  ///< one for each graph
};

void add(KnownScene& known, const Scene& seen, const LaneGraphProblem& problem, const LaneGraph& graph,
         const Evaluation& evaluation) {
    if (std::ranges::find(known.graphs, graph) != known.graphs.end()) return;
    const LaneAnswer answer = answer_of(graph, seen, evaluation.options());
    known.graphs.push_back(graph);
    known.rated.push_back({objective_sums(problem, graph),
                           value_of(answer, *known.annotated, evaluation.boundaries_of(*known.annotated),
                                    evaluation.options())});
}

void add_ground_truth(KnownScene& known, const EvaluatedScene& evaluated, const Evaluation& evaluation) {
    const std::optional<std::size_t> count = seen_count(evaluation.options());
    const std::optional<Lane> lane =
        count ? ground_truth_of_nearest(*known.annotated, *count) : known.annotated->ground_truth;
    if (!lane) return;
    const std::optional<LaneGraph> graph = lane_graph_of(*lane, evaluated.seen);
    if (graph && is_feasible(evaluated.problem, *graph))
        add(known, evaluated.seen, evaluated.problem, *graph, evaluation);
}

/// A problem does not compute a term with weight zero; a fitted weight is never zero.
RldParameters moved_into_ranges(RldParameters parameters) {
    for (const auto& [tuned, term] : tuned_weights(parameters)) {
        parameters.*tuned.value = std::clamp(parameters.*tuned.value, tuned.lowest, tuned.highest);
    }
    return parameters;
}

RldParameters drawn_around(RldParameters parameters, double spread, boost::random::mt19937_64& random) {
    boost::random::normal_distribution<double> standard;
    for (const auto& [tuned, term] : tuned_weights(parameters)) {
        const double drawn = parameters.*tuned.value * std::exp(spread * standard(random));
        parameters.*tuned.value = std::clamp(rounded(drawn), tuned.lowest, tuned.highest);
    }
    return parameters;
}

}  // namespace

std::size_t solves_in(std::size_t rounds) {
    return rounds == 0 ? 0 : 1 + kDrawnFirst + (rounds - 1) * (1 + kDrawnLater);
}

std::vector<RldParameters> fit_weights_in_rounds(const Evaluation& evaluation, const RldParameters& start,
                                                 const std::set<std::string>& tracks,
                                                 const WeightRoundsOptions& options) {
    if (options.rounds > 0 && start.w_b <= 0.0) {
        throw InvalidInput("w_b", "must be positive to fit weights: it is their unit");
    }
    std::vector<KnownScene> known;
    for (const AnnotatedScene& scene : evaluation.scenes()) {
        if (tracks.contains(scene.track)) known.push_back({&scene, {}, {}});
    }
    oneapi::tbb::enumerable_thread_specific<std::unique_ptr<RldSolver>> solvers(
        [] { return make_path_pair_solver(); });
    oneapi::tbb::task_arena arena(
        std::min(static_cast<int>(evaluation.options().threads), oneapi::tbb::info::default_concurrency()));
    const auto solve_all = [&](const RldParameters& parameters) {
        arena.execute([&] {
            oneapi::tbb::parallel_for(std::size_t{0}, known.size(), [&](std::size_t i) {
                KnownScene& scene = known[i];
                const EvaluatedScene evaluated =
                    evaluate(*solvers.local(), scene.annotated->scene, parameters, evaluation.options());
                if (scene.graphs.empty()) add_ground_truth(scene, evaluated, evaluation);
                if (!evaluated.report.lane_graph) return;
                add(scene, evaluated.seen, evaluated.problem, *evaluated.report.lane_graph, evaluation);
            });
        });
        options.on_solved();
    };

    boost::random::mt19937_64 random(options.seed);
    std::vector<RldParameters> after_each;
    RldParameters parameters = moved_into_ranges(start);
    for (std::size_t round = 0; round < options.rounds; ++round) {
        solve_all(parameters);
        for (std::size_t i = 0; i < (round == 0 ? kDrawnFirst : kDrawnLater); ++i) {
            solve_all(drawn_around(parameters, round == 0 ? kSpreadFirst : kSpreadLater, random));
        }
        // A scene whose lane graphs all have the same value does not depend on the weights.
        std::vector<RatedGraphs> informative;
        for (const KnownScene& scene : known) {
            if (scene.rated.empty()) continue;
            const auto [least, most] = std::ranges::minmax(scene.rated, {}, &RatedGraph::value);
            if (least.value < most.value) informative.push_back(scene.rated);
        }
        parameters = fit_weights(informative, parameters);
        after_each.push_back(parameters);
    }
    return after_each;
}

}  // namespace conelane::experiments
