#include "model/constraints/conflict_graph.hpp"
#include "model/constraints/families.hpp"

namespace conelane::constraints {
void width_pairs(const FamilyContext& context) {
    for (const auto& [first, second] : context.problem.conflicts) {
        if (context.rows.stop()) return;
        context.rows.write({"width", {static_cast<std::int32_t>(first), static_cast<std::int32_t>(second)}},
                           -kInfinity, 1.0,
                           {{context.columns.edge[first], 1.0}, {context.columns.edge[second], 1.0}});
    }
}

// Every width conflict is in one of the greedily grown cliques of a graph, and each clique is one row. The
// graph has the width conflicts and the forbidden turns (28), which alone need no row: see `turn_flow`.
void width_cliques(const FamilyContext& context) {
    const auto& [problem, columns, rows] = context;
    const std::size_t edges = problem.edges.size();
    const ConflictGraph graph(problem);
    ConflictGraph uncovered(edges);
    for (const auto& [first, second] : problem.conflicts) uncovered.join(first, second);
    std::vector<std::uint64_t> common(graph.words());
    std::vector<std::size_t> clique;
    std::int32_t count = 0;
    for (const auto& [first, second] : problem.conflicts) {
        if (!uncovered.joined(first, second)) continue;
        if (rows.stop()) return;
        clique.assign({first, second});
        for (std::size_t word = 0; word < common.size(); ++word) {
            common[word] = graph.row(first)[word] & graph.row(second)[word];
        }
        for (std::size_t word = 0; word < common.size(); ++word) {
            while (common[word] != 0) {
                const std::size_t edge = word * 64 + static_cast<std::size_t>(__builtin_ctzll(common[word]));
                clique.push_back(edge);
                for (std::size_t w = word; w < common.size(); ++w) common[w] &= graph.row(edge)[w];
            }
        }
        rows.begin({"width", {count++}}, -kInfinity, 1.0);
        for (const std::size_t edge : clique) {
            rows.add(columns.edge[edge], 1.0);
            for (const std::size_t other : clique) uncovered.part(edge, other);
        }
        rows.end();
    }
}

}  // namespace conelane::constraints
