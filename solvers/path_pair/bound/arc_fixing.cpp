#include "solvers/path_pair/bound/arc_fixing.hpp"

#include "solvers/path_pair/graph/to_index.hpp"

#include <cstddef>
#include <span>

namespace conelane::path_pair {

bool ArcFixing::drop(const PairRelaxation& relaxation, double limit, ResidualGraph& graph) {
    keep_successor_.assign(graph.out_arc.size(), 0);
    order_.clear();
    std::size_t kept = 0;
    for (int a = 0; a < graph.size(); ++a) {
        bool alive = false;
        for (int kind = 0; kind < relaxation.system().kind_count; ++kind) {
            const std::span<const double> forward = relaxation.forward(kind);
            const std::span<const double> backward = relaxation.backward(kind);
            if (!(forward[to_index(a)] + backward[to_index(a)] < limit)) continue;
            alive = true;
            for (int position = graph.out_start[to_index(a)]; position < graph.out_start[to_index(a) + 1];
                 ++position) {
                const std::size_t next = to_index(graph.out_arc[to_index(position)]);
                if (keep_successor_[to_index(position)] != 0) continue;
                const double through = forward[to_index(a)] + graph.out_cost[to_index(position)] +
                                       relaxation.reduced()[next] + backward[next];
                if (!(through < limit)) continue;
                keep_successor_[to_index(position)] = 1;
                ++kept;
            }
        }
        if (alive) order_.push_back(a);
    }
    if (10 * (order_.size() + kept) > 9 * (graph.arc.size() + graph.out_arc.size())) return false;
    spare_.filter(graph, order_, keep_successor_, index_);
    graph = spare_;  // copied, not swapped: a node keeps its memory from search to search
    return true;
}

}  // namespace conelane::path_pair
