#include "experiments/tuning/objective_sums.hpp"

#include <algorithm>
#include <vector>

namespace conelane::experiments {

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

}  // namespace conelane::experiments
