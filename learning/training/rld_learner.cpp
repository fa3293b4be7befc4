#include "learning/training/rld_learner.hpp"

#include "evaluation/world/ground_truth.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace conelane::learning {
namespace {

/// Adds the derivatives of the network's value at these features, times `factor`.
void add_gradient(const LearnedNetwork& network, std::span<const double> features, double factor,
                  LearnedNetwork& gradient) {
    const std::size_t units = network.units();
    for (std::size_t i = 0; i < features.size(); ++i) gradient.linear[i] += factor * features[i];
    for (std::size_t u = 0; u < units; ++u) {
        double sum = 0.0;
        for (std::size_t i = 0; i < features.size(); ++i) sum += network.hidden[i * units + u] * features[i];
        if (sum <= 0.0) continue;
        gradient.output[u] += factor * sum;
        for (std::size_t i = 0; i < features.size(); ++i)
            gradient.hidden[i * units + u] += factor * network.output[u] * features[i];
    }
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

RldLearner::RldLearner(const RldMargin& margin, std::int64_t max_work)
    : margin_(margin), solver_(make_path_pair_solver({.max_work = max_work})) {}

RldLearner::Loss RldLearner::add(const AnnotatedScene& scene, const RldParameters& parameters,
                                 LearnedCosts& gradient) {
    Loss loss;
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
    loss.hinge = std::max(0.0, objective(problem, truth) - objective(problem, *report.lane_graph));
    if (loss.found) return loss;
    const LearnedFeatures features(scene.scene, problem);
    add_cost_gradient(problem, features, truth, 1.0, gradient);
    add_cost_gradient(problem, features, *report.lane_graph, -1.0, gradient);
    return loss;
}

}  // namespace conelane::learning
