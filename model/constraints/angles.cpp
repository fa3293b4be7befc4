#include "model/constraints/families.hpp"

namespace conelane::constraints {

void turn_products(const FamilyContext& context) {
    const auto& [problem, columns, rows] = context;
    for (std::size_t t = 0; t < problem.turns.size(); ++t) {
        if (rows.stop()) return;
        const ProblemTurn& turn = problem.turns[t];
        const auto index = static_cast<std::int32_t>(t);
        const int edge_i = columns.edge[turn.edge_i];
        const int edge_k = columns.edge[turn.edge_k];
        rows.write({"turn_needs_both", {index}}, -kInfinity, 0.0,
                   {{columns.turn[t], 2.0}, {edge_i, -1.0}, {edge_k, -1.0}});  // (22)
        rows.write({"both_make_turn", {index}}, -1.0, kInfinity,
                   {{columns.turn[t], 1.0}, {edge_i, -1.0}, {edge_k, -1.0}});  // (23)
    }
}

// At each cone j the allowed turns carry what enters on one edge out on another, or the path ends there:
//   a_e = sum of f over the turns of edge e at j + e_ij,   sum of f at j + sum of e_ij over i <= 1.
// At integral a the second row and the sum of the first ones, A_j = 2 sum of f + sum of e, allow A_j <= 2,
// which is (2). Degree 2: both sums are at most 1, so the turns carry one unit and none ends; it is the turn
// of the two chosen edges, so (22)(23) hold, and a forbidden turn (28), which has no f, is excluded. Degree
// 1: no turn has both its edges, so e is 1. So f and e need not be integer.
void turn_flow(const FamilyContext& context) {
    const auto& [problem, columns, rows] = context;
    std::vector<std::vector<std::size_t>> turns_at_cone(problem.cone_count);
    for (std::size_t t = 0; t < problem.turns.size(); ++t) {
        if (columns.turn[t] >= 0) turns_at_cone[problem.turns[t].middle].push_back(t);
    }
    std::vector<std::vector<int>> turns_of_edge(problem.edges.size());
    for (std::size_t cone = 0; cone < problem.cone_count; ++cone) {
        if (problem.incident[cone].empty()) continue;
        if (rows.stop()) return;
        for (const std::size_t t : turns_at_cone[cone]) {
            turns_of_edge[problem.turns[t].edge_i].push_back(columns.turn[t]);
            turns_of_edge[problem.turns[t].edge_k].push_back(columns.turn[t]);
        }
        const auto at_cone = static_cast<std::int32_t>(cone);
        for (const std::size_t edge : problem.incident[cone]) {
            rows.begin({"edge_goes_on", {static_cast<std::int32_t>(edge), at_cone}}, 0.0, 0.0);
            for (const int turn : turns_of_edge[edge]) rows.add(turn, 1.0);
            rows.add(end_column(context, edge, cone), 1.0);
            rows.add(columns.edge[edge], -1.0);
            rows.end();
            turns_of_edge[edge].clear();
        }
        rows.begin({"cone_once", {at_cone}}, -kInfinity, 1.0);
        for (const std::size_t t : turns_at_cone[cone]) rows.add(columns.turn[t], 1.0);
        add_endpoint_mark(context, cone, 1.0);
        rows.end();
    }
}

}  // namespace conelane::constraints
