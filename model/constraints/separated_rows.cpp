#include "model/constraints/families.hpp"

namespace conelane::constraints {
namespace {

/// By cone: whether it is listed.
std::vector<bool> marked(std::size_t cone_count, const std::vector<std::size_t>& cones) {
    std::vector<bool> marks(cone_count, false);
    for (const std::size_t cone : cones) marks[cone] = true;
    return marks;
}

}  // namespace

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
        ProgramRow row{.label = {"acyclic", {static_cast<std::int32_t>(start)}},
                       .terms = {},
                       .lower = -kInfinity,
                       .upper = static_cast<double>(walk.size()) - 1.0};
        const std::vector<bool> inside = marked(problem.cone_count, walk);
        for (std::size_t e = 0; e < problem.edges.size(); ++e) {
            if (inside[problem.edges[e].i] && inside[problem.edges[e].j])
                row.terms.emplace_back(columns.edge[e], 1.0);
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

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
        ProgramRow row{
            .label = {"near_far", {static_cast<std::int32_t>(ends[0]), static_cast<std::int32_t>(ends[1])}},
            .terms = {},
            .lower = -kInfinity,
            .upper = static_cast<double>(path.size()) - 2.0};
        const std::vector<bool> on_path = marked(problem.cone_count, path);
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
