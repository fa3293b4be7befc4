#include "experiments/instances/instance_features.hpp"

#include <algorithm>
#include <limits>

namespace conelane::experiments {
namespace {

double share_of(double part, double whole) {
    return whole > 0.0 ? part / whole : 0.0;
}

double pairs_of(std::size_t count) {
    const auto n = static_cast<double>(count);
    return n * (n - 1.0) / 2.0;
}

}  // namespace

InstanceFeatures::Problem problem_features(const LaneGraphProblem& problem) {
    InstanceFeatures::Problem features;
    features.cones = problem.cone_count;
    features.near_cones = static_cast<std::size_t>(std::ranges::count(problem.near, true));
    features.turns = problem.turns.size();
    features.allowed_turns =
        static_cast<std::size_t>(std::ranges::count(problem.turns, false, &ProblemTurn::high_cost));
    features.conflicts = problem.conflicts.size();
    features.far_apart = problem.far_apart.size();
    std::vector<double> degree(problem.cone_count, 0.0);
    double sum = 0.0;
    features.min_cost = std::numeric_limits<double>::infinity();
    for (const ProblemEdge& edge : problem.edges) {
        if (edge.high_cost) continue;
        ++features.edges;
        ++degree[edge.i];
        ++degree[edge.j];
        sum += edge.cost;
        features.min_cost = std::min(features.min_cost, edge.cost);
    }
    if (features.edges == 0) features.min_cost = 0.0;
    features.mean_cost = share_of(sum, static_cast<double>(features.edges));
    features.edge_density = share_of(static_cast<double>(features.edges), pairs_of(features.cones));
    features.conflict_density = share_of(static_cast<double>(features.conflicts), pairs_of(features.edges));
    features.mean_degree =
        share_of(2.0 * static_cast<double>(features.edges), static_cast<double>(features.cones));
    if (!degree.empty()) features.max_degree = std::ranges::max(degree);
    return features;
}

std::vector<NamedFeature> named(const InstanceFeatures& features) {
    const InstanceFeatures::Problem& p = features.problem;
    const auto number = [](std::size_t count) { return static_cast<double>(count); };
    return {{"cones", number(p.cones)},         {"near_cones", number(p.near_cones)},
            {"edges", number(p.edges)},         {"edge_density", p.edge_density},
            {"turns", number(p.turns)},         {"allowed_turns", number(p.allowed_turns)},
            {"conflicts", number(p.conflicts)}, {"conflict_density", p.conflict_density},
            {"far_apart", number(p.far_apart)}, {"mean_degree", p.mean_degree},
            {"max_degree", p.max_degree},       {"min_cost", p.min_cost},
            {"mean_cost", p.mean_cost}};
}

}  // namespace conelane::experiments
