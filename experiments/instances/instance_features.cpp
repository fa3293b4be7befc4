#include "experiments/instances/instance_features.hpp"

#include "model/deadline.hpp"
#include "model/lane_graph_model.hpp"
#include "solvers/relaxation/linear_relaxation.hpp"

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

std::optional<InstanceFeatures::Relaxation> relaxation_features(const LaneGraphProblem& problem) {
    if (problem.edges.empty()) return std::nullopt;
    const LaneGraphModel model(problem, Formulation::tight);
    const BinaryProgram& program = model.program();
    const auto shape = relaxation_shape(program);
    if (!shape) return std::nullopt;
    InstanceFeatures::Relaxation features;
    features.columns = program.columns.size();
    features.rows = program.rows.size();
    features.entries = program.entry_columns.size();
    features.optimum = shape->optimum;
    const auto share = [](std::size_t part, std::size_t whole) {
        return share_of(static_cast<double>(part), static_cast<double>(whole));
    };
    features.fractional = share(shape->fractional, problem.edges.size());
    features.degenerate = share(shape->degenerate, features.rows);
    features.dual_degenerate = share(shape->dual_degenerate, features.columns);
    return features;
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

InstanceFeatures features_of(const Scene& cones, const RldParameters& parameters) {
    InstanceFeatures features;
    const Stopwatch problem_watch;
    const LaneGraphProblem problem = make_problem(cones, parameters);
    features.problem = problem_features(problem);
    features.problem_ms = problem_watch.elapsed_ms();
    const Stopwatch relaxation_watch;
    features.relaxation = relaxation_features(problem);
    features.relaxation_ms = relaxation_watch.elapsed_ms();
    return features;
}

std::vector<NamedFeature> named(const InstanceFeatures& features) {
    const InstanceFeatures::Problem& p = features.problem;
    const auto number = [](std::size_t count) { return static_cast<double>(count); };
    std::vector<NamedFeature> all{
        {"cones", number(p.cones)},         {"near_cones", number(p.near_cones)},
        {"edges", number(p.edges)},         {"edge_density", p.edge_density},
        {"turns", number(p.turns)},         {"allowed_turns", number(p.allowed_turns)},
        {"conflicts", number(p.conflicts)}, {"conflict_density", p.conflict_density},
        {"far_apart", number(p.far_apart)}, {"mean_degree", p.mean_degree},
        {"max_degree", p.max_degree},       {"min_cost", p.min_cost},
        {"mean_cost", p.mean_cost}};
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    const InstanceFeatures::Relaxation* const r = features.relaxation ? &*features.relaxation : nullptr;
    const auto put = [&](std::string_view name, auto value) {
        all.push_back({name, r == nullptr ? kUnknown : static_cast<double>(value(*r))});
    };
    using Relaxation = InstanceFeatures::Relaxation;
    put("columns", [](const Relaxation& of) { return of.columns; });
    put("rows", [](const Relaxation& of) { return of.rows; });
    put("entries", [](const Relaxation& of) { return of.entries; });
    put("lp_optimum", [](const Relaxation& of) { return of.optimum; });
    put("lp_fractional", [](const Relaxation& of) { return of.fractional; });
    put("lp_degenerate", [](const Relaxation& of) { return of.degenerate; });
    put("lp_dual_degenerate", [](const Relaxation& of) { return of.dual_degenerate; });
    return all;
}

}  // namespace conelane::experiments
