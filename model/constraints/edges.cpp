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
        const auto index = [](std::size_t cone) { return static_cast<std::int32_t>(cone); };
        rows.write({"spacing_limit", {index(problem.edges[edge].i), index(problem.edges[edge].j)}}, 0.0, 0.0,
                   {{columns.edge[edge], 1.0}});
    }
}

void turn_limits(const FamilyContext& context) {
    const auto& [problem, columns, rows] = context;
    for (std::size_t turn = 0; turn < problem.turns.size(); ++turn) {
        if (!problem.turns[turn].high_cost) continue;
        if (rows.stop()) return;
        rows.write({"angle_limit", {static_cast<std::int32_t>(turn)}}, 0.0, 0.0, {{columns.turn[turn], 1.0}});
    }
}

}  // namespace conelane::constraints
