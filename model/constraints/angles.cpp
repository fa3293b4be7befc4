#include "model/constraints/families.hpp"

namespace conelane::constraints {

void turn_products(const FamilyContext& context) {
    const auto& [problem, columns, rows] = context;
    for (std::size_t t = 0; t < problem.turns.size(); ++t) {
        const ProblemTurn& turn = problem.turns[t];
        const auto index = static_cast<std::int32_t>(t);
        const int edge_i = columns.edge[turn.edge_i];
        const int edge_k = columns.edge[turn.edge_k];
        rows.begin({"turn_needs_both", {index}}, -kInfinity, 0.0);  // (22)
        rows.add(columns.turn[t], 2.0);
        rows.add(edge_i, -1.0);
        rows.add(edge_k, -1.0);
        rows.end();
        rows.begin({"both_make_turn", {index}}, -1.0, kInfinity);  // (23)
        rows.add(columns.turn[t], 1.0);
        rows.add(edge_i, -1.0);
        rows.add(edge_k, -1.0);
        rows.end();
    }
}

// At each cone j the allowed turns carry what enters on one edge out on another:
//   sum of f over the turns of edge e at j <= a_e,   sum of f at j = A_j - g_j.
// At integral a: degree 2 forces exactly one turn, which must be of the two chosen edges, so (22)(23) hold
// and a forbidden turn (28), which has no f, is excluded; degree 1 gives g_j = 1. Adding the first rows over
// the edges of j gives 2 (A_j - g_j) <= A_j, which is (2); f >= 0 gives (1). So f and g need not be integer.
void turn_flow(const FamilyContext& context) {
    const auto& [problem, columns, rows] = context;
    std::vector<std::vector<std::size_t>> turns_at_cone(problem.cone_count);
    for (std::size_t t = 0; t < problem.turns.size(); ++t) {
        if (columns.turn[t] >= 0) turns_at_cone[problem.turns[t].middle].push_back(t);
    }
    std::vector<std::vector<int>> turns_of_edge(problem.edges.size());
    for (std::size_t cone = 0; cone < problem.cone_count; ++cone) {
        for (const std::size_t t : turns_at_cone[cone]) {
            turns_of_edge[problem.turns[t].edge_i].push_back(columns.turn[t]);
            turns_of_edge[problem.turns[t].edge_k].push_back(columns.turn[t]);
        }
        for (const std::size_t edge : problem.incident[cone]) {
            if (turns_of_edge[edge].empty()) continue;
            rows.begin({"turns_of_edge", {static_cast<std::int32_t>(edge), static_cast<std::int32_t>(cone)}},
                       -kInfinity, 0.0);
            for (const int turn : turns_of_edge[edge]) rows.add(turn, 1.0);
            rows.add(columns.edge[edge], -1.0);
            rows.end();
            turns_of_edge[edge].clear();
        }
        rows.begin({"turns_at_cone", {static_cast<std::int32_t>(cone)}}, 0.0, 0.0);
        for (const std::size_t t : turns_at_cone[cone]) rows.add(columns.turn[t], 1.0);
        for (const std::size_t edge : problem.incident[cone]) rows.add(columns.edge[edge], -1.0);
        rows.add(columns.inlier[cone], 1.0);
        rows.end();
    }
}

}  // namespace conelane::constraints
