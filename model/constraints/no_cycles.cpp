#include "model/constraints/families.hpp"

#include <limits>

namespace conelane::constraints {

// The row of a cone set S that holds a cycle: sum of a inside S <= |S| - 1.
std::vector<ProgramRow> separate_cycles(const LaneGraphProblem& problem, const ColumnMap& columns,
                                        const std::vector<bool>& chosen) {
    constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
    std::vector<bool> visited(problem.cone_count, false);
    const auto next_edge = [&](std::size_t cone, std::size_t arrived_by) {
        for (const std::size_t edge : problem.incident[cone]) {
            if (chosen[edge] && edge != arrived_by) return edge;
        }
        return kNone;
    };
    const auto other_end = [&](std::size_t edge, std::size_t cone) {
        return problem.edges[edge].i == cone ? problem.edges[edge].j : problem.edges[edge].i;
    };
    std::vector<ProgramRow> rows;
    for (std::size_t start = 0; start < problem.cone_count; ++start) {
        if (visited[start]) continue;
        visited[start] = true;
        std::vector<std::size_t> walk{start};
        std::size_t edge = next_edge(start, kNone);
        std::size_t cone = start;
        while (edge != kNone) {
            cone = other_end(edge, cone);
            if (visited[cone]) break;
            visited[cone] = true;
            walk.push_back(cone);
            edge = next_edge(cone, edge);
        }
        if (edge == kNone || cone != start) continue;
        ProgramRow row{{"acyclic", {static_cast<std::int32_t>(start)}},
                       {},
                       -kInfinity,
                       static_cast<double>(walk.size()) - 1.0};
        std::vector<bool> inside(problem.cone_count, false);
        for (const std::size_t member : walk) inside[member] = true;
        for (std::size_t e = 0; e < problem.edges.size(); ++e) {
            if (inside[problem.edges[e].i] && inside[problem.edges[e].j])
                row.terms.emplace_back(columns.edge[e], 1.0);
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace conelane::constraints
