#include "model/constraints/families.hpp"

namespace conelane::constraints {

void heading(const FamilyContext& context) {
    const auto& [problem, columns, rows] = context;
    rows.begin({"heading"}, 2.0, kInfinity);
    for (std::size_t edge = 0; edge < problem.edges.size(); ++edge) {
        if (problem.edges[edge].along_heading) rows.add(columns.edge[edge], 1.0);
    }
    rows.end();
}

void edge_limits(const FamilyContext& context) {
    const auto& [problem, columns, rows] = context;
    for (std::size_t edge = 0; edge < problem.edges.size(); ++edge) {
        if (!problem.edges[edge].high_cost) continue;
        rows.begin({"spacing_limit",
                    {static_cast<std::int32_t>(problem.edges[edge].i),
                     static_cast<std::int32_t>(problem.edges[edge].j)}},
                   0.0, 0.0);
        rows.add(columns.edge[edge], 1.0);
        rows.end();
    }
}

void turn_limits(const FamilyContext& context) {
    const auto& [problem, columns, rows] = context;
    for (std::size_t turn = 0; turn < problem.turns.size(); ++turn) {
        if (!problem.turns[turn].high_cost) continue;
        if (rows.stop()) return;
        rows.begin({"angle_limit", {static_cast<std::int32_t>(turn)}}, 0.0, 0.0);
        rows.add(columns.turn[turn], 1.0);
        rows.end();
    }
}

}  // namespace conelane::constraints
