#include "solvers/path_pair/bound/walk_usage.hpp"

#include "solvers/path_pair/graph/to_index.hpp"

namespace conelane::path_pair {

void WalkUsage::reset(const ArcGraph& graph) {
    edges_.assign(to_index(graph.edge_count()), 0.0);
    ends_.assign(to_index(graph.cone_count()), 0.0);
}

void WalkUsage::count(const ArcGraph& graph, const CliquePool& cliques, const ResidualGraph& residual,
                      PairRelaxation& relaxation, double memory) {
    last_.cone.assign(to_index(graph.cone_count()), 0);
    last_.clique.assign(to_index(cliques.size()), 0);
    last_.along_heading = 0;
    for (double& use : edges_) use *= memory;
    for (double& use : ends_) use *= memory;
    for (const int end : relaxation.ends()) {
        if (end >= 0) ends_[to_index(end)] += 1.0 - memory;
    }
    times_.assign(to_index(graph.edge_count()), 0);
    for (const std::vector<int>& walk : relaxation.walks(residual)) {
        if (walk.empty()) continue;
        ++last_.cone[to_index(residual.tail[to_index(walk.front())])];
        for (const int a : walk) {
            const int edge = residual.edge(a);
            ++last_.cone[to_index(residual.head[to_index(a)])];
            edges_[to_index(edge)] += 1.0 - memory;
            ++times_[to_index(edge)];
            last_.along_heading += graph.along_heading(edge) ? 1 : 0;
        }
    }
    for (int q = 0; q < cliques.size(); ++q) {
        for (const int edge : cliques.edges(q)) last_.clique[to_index(q)] += times_[to_index(edge)];
    }
}

}  // namespace conelane::path_pair
