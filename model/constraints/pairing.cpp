#include "model/constraints/families.hpp"

#include <algorithm>
#include <array>

namespace conelane::constraints {

// A path P with near ends e and f must continue at one of them or lose an edge:
//   a(P) - a(delta(e) \ P) - a(delta(f) \ P) <= |P| - 1.
std::vector<ProgramRow> separate_near_near(const LaneGraphProblem& problem, const ColumnMap& columns,
                                           const std::vector<bool>& chosen) {
    LaneGraph graph;
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        if (chosen[e]) graph.edges.push_back({problem.edges[e].i, problem.edges[e].j});
    }
    std::vector<ProgramRow> rows;
    const auto found = paths(graph, problem.cone_count);
    if (!found) return rows;
    for (const std::vector<std::size_t>& path : *found) {
        const std::array ends{path.front(), path.back()};
        if (!problem.near[ends[0]] || !problem.near[ends[1]]) continue;
        ProgramRow row{{"near_far", {static_cast<std::int32_t>(ends[0]), static_cast<std::int32_t>(ends[1])}},
                       {},
                       -kInfinity,
                       static_cast<double>(path.size()) - 2.0};
        std::vector<bool> on_path(problem.cone_count, false);
        for (const std::size_t cone : path) on_path[cone] = true;
        for (std::size_t e = 0; e < problem.edges.size(); ++e) {
            const ProblemEdge& edge = problem.edges[e];
            if (chosen[e] && on_path[edge.i]) {
                row.terms.emplace_back(columns.edge[e], 1.0);
            } else if (std::ranges::find(ends, edge.i) != ends.end() ||
                       std::ranges::find(ends, edge.j) != ends.end()) {
                row.terms.emplace_back(columns.edge[e], -1.0);
            }
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace conelane::constraints
