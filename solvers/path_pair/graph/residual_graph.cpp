#include "solvers/path_pair/graph/residual_graph.hpp"

#include <cassert>

namespace conelane::path_pair {

bool ResidualGraph::assign(const ArcGraph& graph, std::span<const char> starting_cone, SearchClock& clock) {
    if (collect(graph, starting_cone, clock) && index_predecessors(&clock)) return true;
    for (std::vector<int>* const list : {&arc, &tail, &head, &out_arc, &in_arc}) list->clear();
    out_cost.clear();
    in_cost.clear();
    out_start.assign(1, 0);
    in_start.assign(1, 0);
    return false;
}

bool ResidualGraph::collect(const ArcGraph& graph, std::span<const char> starting_cone, SearchClock& clock) {
    arc.clear();
    std::vector<int>& index = in_arc;  // rewritten below
    index.assign(to_index(graph.arc_count()), -1);
    const auto reach = [&](int a) {
        if (index[to_index(a)] >= 0) return;
        index[to_index(a)] = size();
        arc.push_back(a);
    };
    for (int a = 0; a < graph.arc_count(); ++a) {
        if (starting_cone[to_index(graph.tail(a))] != 0) reach(a);
    }
    // NOLINTNEXTLINE(modernize-loop-convert): `reach` appends to `arc`
    for (std::size_t done = 0; done < arc.size(); ++done) {
        const std::span<const ArcGraph::Succession> successions = graph.successions(arc[done]);
        if (clock.out_of_time(2 * successions.size())) return false;
        for (const ArcGraph::Succession& next : successions) reach(next.arc);
    }
    tail.resize(arc.size());
    head.resize(arc.size());
    out_start.resize(arc.size() + 1);
    out_start[0] = 0;
    for (std::size_t a = 0; a < arc.size(); ++a) {
        tail[a] = graph.tail(arc[a]);
        head[a] = graph.head(arc[a]);
        out_start[a + 1] = out_start[a] + static_cast<int>(graph.successions(arc[a]).size());
    }
    const auto count = to_index(out_start.back());
    out_arc.clear();
    out_arc.reserve(count);
    out_cost.clear();
    out_cost.reserve(count);
    for (const int a : arc) {
        const std::span<const ArcGraph::Succession> successions = graph.successions(a);
        if (clock.out_of_time(5 * successions.size())) return false;
        for (const ArcGraph::Succession& next : successions) {
            out_arc.push_back(index[to_index(next.arc)]);
            out_cost.push_back(next.cost);
        }
    }
    return true;
}

void ResidualGraph::filter(const ResidualGraph& source, std::span<const int> order,
                           std::span<const char> keep_successor, std::vector<int>& index) {
    assert(this != &source);
    index.assign(source.arc.size(), -1);
    arc.clear();
    tail.clear();
    head.clear();
    for (const int old : order) {
        const auto a = to_index(old);
        index[a] = size();
        arc.push_back(source.arc[a]);
        tail.push_back(source.tail[a]);
        head.push_back(source.head[a]);
    }
    out_start.assign(1, 0);
    out_arc.clear();
    out_cost.clear();
    for (const int old : order) {
        const auto a = to_index(old);
        for (int position = source.out_start[a]; position < source.out_start[a + 1]; ++position) {
            const auto p = to_index(position);
            const int next = index[to_index(source.out_arc[p])];
            if (keep_successor[p] == 0 || next < 0) continue;
            out_arc.push_back(next);
            out_cost.push_back(source.out_cost[p]);
        }
        out_start.push_back(static_cast<int>(out_arc.size()));
    }
    index_predecessors();
}

/// False if there is a clock and its time has ended.
bool ResidualGraph::index_predecessors(SearchClock* clock) {
    in_start.assign(arc.size() + 2, 0);
    for (const int next : out_arc) ++in_start[to_index(next) + 2];
    for (std::size_t a = 2; a < in_start.size(); ++a) in_start[a] += in_start[a - 1];
    in_arc.resize(out_arc.size());
    in_cost.resize(out_arc.size());
    for (int a = 0; a < size(); ++a) {
        const auto from = to_index(a);
        const auto successions = to_index(out_start[from + 1] - out_start[from]);
        if (clock != nullptr && clock->out_of_time(5 * successions)) return false;
        for (int position = out_start[from]; position < out_start[from + 1]; ++position) {
            const auto p = to_index(position);
            const auto slot = to_index(in_start[to_index(out_arc[p]) + 1]++);
            in_arc[slot] = a;
            in_cost[slot] = out_cost[p];
        }
    }
    in_start.pop_back();
    return true;
}

}  // namespace conelane::path_pair
