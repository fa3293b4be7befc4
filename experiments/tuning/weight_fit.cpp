#include "experiments/tuning/weight_fit.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/proofs/answer_check.hpp"
#include "evaluation/world/ground_truth.hpp"
#include "experiments/progress/parallel.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <nlopt.hpp>

namespace conelane::experiments {
namespace {

double objective_of(const RatedGraph& graph, const RldParameters& parameters) {
    double sum = 0.0;
    for (std::size_t term = 0; term < kObjectiveTermCount; ++term) {
        sum += parameters.*kObjectiveWeights[term] * graph.sums[term];
    }
    return sum;
}

/// Keeps the best point evaluated, whatever the algorithm returns.
class Fit {
  public:
    Fit(std::span<const RatedGraphs> scenes, const RldParameters& start)
        : scenes_(scenes), weights_(tuned_weights(start)), parameters_(start) {
        for (const auto& [parameter, term] : weights_) {
            lower_.push_back(std::log(parameter.lowest));
            upper_.push_back(std::log(parameter.highest));
            best_point_.push_back(std::clamp(std::log(start.*parameter.value), lower_.back(), upper_.back()));
        }
    }

    void run() {
        constexpr int kMaxSteps = 500;
        constexpr double kMinStep = 1e-6;
        nlopt::opt search(nlopt::LD_MMA, static_cast<unsigned>(best_point_.size()));
        search.set_lower_bounds(lower_);
        search.set_upper_bounds(upper_);
        search.set_max_objective(&Fit::value, this);
        search.set_maxeval(kMaxSteps);
        search.set_xtol_abs(kMinStep);
        std::vector<double> point = best_point_;
        double reached = 0.0;
        try {
            search.optimize(point, reached);
        } catch (const std::runtime_error&) {
            // If no step improved it, the best point is kept.
        }
    }

    [[nodiscard]] RldParameters parameters() {
        move_to(best_point_);
        for (const auto& [parameter, term] : weights_) {
            double& weight = parameters_.*parameter.value;
            weight = std::clamp(rounded(weight), parameter.lowest, parameter.highest);
        }
        return parameters_;
    }

  private:
    static double value(const std::vector<double>& point, std::vector<double>& gradient, void* self) {
        return static_cast<Fit*>(self)->value(point, gradient);
    }
    double value(const std::vector<double>& point, std::vector<double>& gradient) {
        move_to(point);
        ObjectiveSums by_term{};
        const double expected = expected_value(scenes_, parameters_, &by_term);
        for (std::size_t i = 0; i < gradient.size(); ++i) gradient[i] = by_term[weights_[i].term];
        if (expected > best_) {
            best_ = expected;
            best_point_ = point;
        }
        return expected;
    }
    void move_to(const std::vector<double>& point) {
        for (std::size_t i = 0; i < weights_.size(); ++i) {
            parameters_.*weights_[i].parameter.value = std::exp(point[i]);
        }
    }

    std::span<const RatedGraphs> scenes_;
    std::vector<TunedWeight> weights_;
    RldParameters parameters_;
    std::vector<double> lower_;
    std::vector<double> upper_;
    std::vector<double> best_point_;  ///< logarithms of the weights
    double best_ = -1.0;
};

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

ObjectiveSums objective_sums(const LaneGraphProblem& problem, const LaneGraph& graph) {
    const RldParameters& p = problem.parameters;
    ObjectiveSums sums{};
    const auto sum_of = [&](ObjectiveTerm term) -> double& { return sums[static_cast<std::size_t>(term)]; };
    std::vector<bool> chosen(problem.edges.size(), false);
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        const ProblemEdge& edge = problem.edges[e];
        chosen[e] = std::ranges::binary_search(graph.edges, Edge{edge.i, edge.j});
        if (!chosen[e]) continue;
        const double near_ends = -(problem.near_end_fit[edge.i] + problem.near_end_fit[edge.j]);
        sum_of(ObjectiveTerm::spacing) += edge.spacing_cost;
        sum_of(ObjectiveTerm::heading) += edge.heading_cost;
        sum_of(ObjectiveTerm::color) += edge.color_cost;
        sum_of(ObjectiveTerm::facing) += edge.facing_cost;
        sum_of(ObjectiveTerm::near_ends) += near_ends;
        // With confidences, edges have different benefits: the benefit is then the rest of the cost.
        const double others = p.w_s * edge.spacing_cost + p.w_p * edge.heading_cost +
                              p.w_color * edge.color_cost + p.facing_weight * edge.facing_cost +
                              p.near_end_weight * near_ends;
        if (p.w_b > 0.0) sum_of(ObjectiveTerm::benefit) += (edge.cost - others) / p.w_b;
    }
    for (const ProblemTurn& turn : problem.turns) {
        if (!chosen[turn.edge_i] || !chosen[turn.edge_k]) continue;
        sum_of(ObjectiveTerm::angle) += turn.angle_cost;
        sum_of(ObjectiveTerm::unevenness) += turn.unevenness;
        sum_of(ObjectiveTerm::near_ends) += 2.0 * problem.near_end_fit[turn.middle];
    }
    return sums;
}

std::vector<TunedWeight> tuned_weights(const RldParameters& start) {
    std::vector<TunedWeight> weights;
    for (const TunedParameter& parameter : tuned_parameters(start)) {
        const auto weight = std::ranges::find(kObjectiveWeights, parameter.value);
        if (weight == kObjectiveWeights.end()) continue;
        weights.push_back({parameter, static_cast<std::size_t>(weight - kObjectiveWeights.begin())});
    }
    return weights;
}

double expected_value(std::span<const RatedGraphs> scenes, const RldParameters& parameters,
                      ObjectiveSums* gradient) {
    if (gradient != nullptr) gradient->fill(0.0);
    if (scenes.empty()) return 0.0;
    const double sharpness = kSharpness / parameters.w_b;
    double total = 0.0;
    std::vector<double> shares;
    for (const RatedGraphs& graphs : scenes) {
        shares.clear();
        for (const RatedGraph& graph : graphs) shares.push_back(objective_of(graph, parameters));
        const double least = std::ranges::min(shares);
        double sum = 0.0;
        for (double& share : shares) sum += share = std::exp(-sharpness * (share - least));
        double expected = 0.0;
        for (std::size_t i = 0; i < graphs.size(); ++i) {
            shares[i] /= sum;
            expected += shares[i] * graphs[i].value;
        }
        total += expected;
        if (gradient == nullptr) continue;
        for (std::size_t i = 0; i < graphs.size(); ++i) {
            const double by_objective = sharpness * shares[i] * (expected - graphs[i].value);
            for (std::size_t term = 0; term < kObjectiveTermCount; ++term) {
                (*gradient)[term] += by_objective * graphs[i].sums[term];
            }
        }
    }
    const auto count = static_cast<double>(scenes.size());
    if (gradient != nullptr) {
        for (std::size_t term = 0; term < kObjectiveTermCount; ++term) {
            (*gradient)[term] *= parameters.*kObjectiveWeights[term] / count;
        }
        (*gradient)[static_cast<std::size_t>(ObjectiveTerm::benefit)] = 0.0;
    }
    return total / count;
}

RldParameters fit_weights(std::span<const RatedGraphs> scenes, const RldParameters& start) {
    Fit fit(scenes, start);
    fit.run();
    return fit.parameters();
}

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
    const auto solve_all = [&](const RldParameters& parameters) {
        in_parallel(
            known.size(), evaluation.options().threads, [] { return make_path_pair_solver(); },
            [&](std::unique_ptr<RldSolver>& solver, std::size_t i) {
                KnownScene& scene = known[i];
                const EvaluatedScene evaluated =
                    evaluate(*solver, scene.annotated->scene, parameters, evaluation.options());
                if (scene.graphs.empty()) add_ground_truth(scene, evaluated, evaluation);
                if (!evaluated.report.lane_graph) return;
                add(scene, evaluated.seen, evaluated.problem, *evaluated.report.lane_graph, evaluation);
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
