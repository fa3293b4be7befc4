#include "learning/training/rld_training.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/formats/parameter_file.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"

namespace conelane::learning {
namespace {

/// The place of a feature among those of its part.
std::size_t place_of(LearnedPart part, std::string_view name) {
    const auto features = learned_features(part);
    const auto found = std::ranges::find(features, name, &LearnedFeature::name);
    return static_cast<std::size_t>(found - features.begin());
}

double& weight(LearnedCosts& costs, LearnedPart part, std::string_view name) {
    return costs.of(part).linear.at(place_of(part, name));
}

LearnedCosts initial_costs(const RldTrainingOptions& options) {
    const LearnedCosts start = options.parameters.learned_costs ? *options.parameters.learned_costs
                                                                : as_learned_costs(options.start);
    const bool is_linear = std::ranges::all_of(
        start.networks, [](const LearnedNetwork& network) { return network.units() == 0; });
    return is_linear ? with_hidden_units(start, options.units, options.seed) : start;
}

void validate(const RldTrainingOptions& options) {
    RldTrainingOptions copy = options;
    require_in_range(option_fields(copy));
    validate(options.parameters);
    if (!options.parameters.learned_costs) return;
    require_units(options.parameters.learned_costs->networks, options.units);
}

}  // namespace

LaneGraph true_lane_graph(const AnnotatedScene& scene) {
    const auto index_of = index_by_id(scene.scene);
    LaneGraph graph;
    for (const std::vector<ConeId>* side : {&scene.ground_truth->left, &scene.ground_truth->right}) {
        for (std::size_t i = 1; i < side->size(); ++i)
            graph.edges.push_back(make_edge(index_of.at((*side)[i - 1]), index_of.at((*side)[i])));
    }
    std::ranges::sort(graph.edges);
    return graph;
}

void add_cost_gradient(const LaneGraphProblem& problem, const LearnedFeatures& features,
                       const LaneGraph& graph, double factor, LearnedCosts& gradient) {
    const LearnedCosts& costs = *problem.parameters.learned_costs;
    std::vector<char> chosen(problem.edges.size(), 0);
    std::vector<int> degree(problem.cone_count, 0);
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        const ProblemEdge& edge = problem.edges[e];
        if (!std::ranges::binary_search(graph.edges, Edge{edge.i, edge.j})) continue;
        chosen[e] = 1;
        ++degree[edge.i];
        ++degree[edge.j];
        add_gradient(costs.of(LearnedPart::edge), features.edge(e), factor, gradient.of(LearnedPart::edge));
    }
    for (const ProblemTurn& turn : problem.turns) {
        if (chosen[turn.edge_i] == 0 || chosen[turn.edge_k] == 0) continue;
        const auto x = features.turn(turn.edge_i, turn.edge_k, turn.middle, turn.angle_cost);
        const LearnedNetwork& network = costs.of(LearnedPart::turn);
        if (network(x) > 0.0 || factor < 0.0)
            add_gradient(network, x, factor, gradient.of(LearnedPart::turn));
    }
    const auto add_end = [&](LearnedPart part, std::span<const double> x) {
        if (costs.of(part)(x) < 0.0 || factor > 0.0)
            add_gradient(costs.of(part), x, factor, gradient.of(part));
    };
    for (std::size_t cone = 0; cone < problem.cone_count; ++cone) {
        if (degree[cone] != 1) continue;
        if (problem.near[cone]) {
            add_end(LearnedPart::near_end, features.near_end(cone));
        } else {
            add_end(LearnedPart::far_end, features.far_end(cone));
        }
    }
}

RldLearner::RldLearner(const RldTrainingOptions& options)
    : margin_(options.margin), solver_(make_path_pair_solver({.max_work = options.max_work})) {}

CostLoss RldLearner::add(const AnnotatedScene& scene, const RldParameters& parameters,
                         LearnedCosts& gradient) {
    CostLoss loss;
    LaneGraphProblem problem = make_problem(scene.scene, parameters);
    const LaneGraph truth = true_lane_graph(scene);
    loss.allowed = !is_too_large(problem) && is_feasible(problem, truth);
    if (!loss.allowed) return loss;
    for (ProblemEdge& edge : problem.edges) {
        const Point middle = 0.5 * (scene.scene.cones[edge.i].position + scene.scene.cones[edge.j].position);
        const bool is_near = (middle - scene.scene.pose.position).norm() < margin_.near_m;
        const bool is_true = std::ranges::binary_search(truth.edges, Edge{edge.i, edge.j});
        edge.cost += (is_true ? 1.0 : -1.0) * (is_near ? margin_.near : margin_.far);
    }
    const RldReport report = solver_->solve(problem, {.start = &truth});
    loss.proven = report.status == SolveStatus::optimal;
    if (!report.lane_graph) return loss;
    loss.found = *report.lane_graph == truth;
    loss.loss = std::max(0.0, objective(problem, truth) - objective(problem, *report.lane_graph));
    if (loss.found) return loss;
    const LearnedFeatures features(scene.scene, problem);
    add_cost_gradient(problem, features, truth, 1.0, gradient);
    add_cost_gradient(problem, features, *report.lane_graph, -1.0, gradient);
    return loss;
}

RldParameters rld_learning_parameters() {
    RldParameters parameters = with_shape_costs({});
    for (double RldParameters::*const weight :
         {&RldParameters::w_s, &RldParameters::w_t, &RldParameters::w_p, &RldParameters::w_b,
          &RldParameters::unevenness_weight, &RldParameters::facing_weight,
          &RldParameters::near_end_weight}) {
        parameters.*weight = 0.0;
    }
    parameters.t_crit = 12.0;
    parameters.d_min = 1.7;
    parameters.d_h = 8.0;
    parameters.theta_heading = 1.4;
    parameters.d_near = 9.0;
    parameters.d_side = 4.5;
    parameters.d_max = 7.0;
    parameters.d_gap = 12.5;
    parameters.theta_gap = 1.3;
    parameters.d_clear = 0.2;
    parameters.nearest_of_edge = 8.0;
    parameters.nearest_of_gap = 16.0;
    return parameters;
}

LearnedCosts as_learned_costs(const RldParameters& shape) {
    // Cost of each turn and end, so that training can lower it before a limit of LearnedCosts holds.
    constexpr double kMoved = 0.5;
    constexpr double kEnd = -1.0;
    LearnedCosts costs = LearnedCosts::zero();
    weight(costs, LearnedPart::edge, "one") = -shape.w_b - kMoved;
    weight(costs, LearnedPart::edge, "spacing") = shape.w_s;
    weight(costs, LearnedPart::edge, "heading") = shape.w_p;
    weight(costs, LearnedPart::edge, "facing") = shape.facing_weight;
    weight(costs, LearnedPart::turn, "one") = kMoved;
    weight(costs, LearnedPart::turn, "angle_cost") = shape.w_t;
    weight(costs, LearnedPart::turn, "unevenness") = shape.unevenness_weight;
    weight(costs, LearnedPart::near_end, "one") = kEnd;
    weight(costs, LearnedPart::near_end, "fit") = -shape.near_end_weight;
    weight(costs, LearnedPart::far_end, "one") = kEnd;
    return costs;
}

LearnedCosts with_hidden_units(const LearnedCosts& linear, std::size_t units, std::uint64_t seed) {
    LearnedCosts costs = linear;
    add_hidden_units(costs.networks, units, seed);
    // Without colours and confidences in the training these features are 0, and no weight of theirs changes.
    for (const std::string_view evidence : {"color_cost", "same_color", "doubt"}) {
        const std::size_t place = place_of(LearnedPart::edge, evidence);
        std::fill_n(costs.of(LearnedPart::edge).hidden.begin() + static_cast<std::ptrdiff_t>(place * units),
                    units, 0.0);
    }
    return costs;
}

OptionFields option_fields(RldTrainingOptions& options) {
    options.parameters_hash = tag_of("", options.parameters).hash.value();
    options.start_hash = options.parameters.learned_costs ? "" : tag_of("", options.start).hash.value();
    return cost_fields(
        options, {{"", "parameters_hash", &options.parameters_hash},
                  {"", "start_hash", &options.start_hash},
                  {"--margin", "margin.near", &options.margin.near, kNotNegative,
                   "cost by which the true lane has to beat another one, for each edge within 20 m "
                   "that differs"},
                  {"--far-margin", "margin.far", &options.margin.far, kNotNegative, "the same beyond 20 m"},
                  {"", "margin.near_m", &options.margin.near_m},
                  {"--max-work",
                   "max_work",
                   &options.max_work,
                   {.least = 1.0},
                   "limit of each exact search, in steps of about a nanosecond; then its best lane "
                   "counts"}});
}

LearnedCosts train_rld(const std::vector<Track>& courses, const RldTrainingOptions& options,
                       const std::function<void(const std::string&)>& say) {
    validate(options);
    return CostTraining<RldLearner, RldTrainingOptions>(courses, options, initial_costs(options), say)
        .run(courses);
}

RldTrainingRun run_rld_training(const std::vector<std::string>& tracks, const RldTrainingOptions& options,
                                const std::function<void(const std::string&)>& say) {
    const std::vector<Track> courses = annotated_tracks(tracks);
    RldTrainingRun run;
    run.parameters = options.parameters;
    run.parameters.learned_costs = std::make_shared<const LearnedCosts>(train_rld(courses, options, say));
    run.record = training_record(courses, options);
    return run;
}

}  // namespace conelane::learning
