#pragma once

#include "solvers/path_pair/graph/arc_graph.hpp"

namespace conelane::path_pair {

inline constexpr double kUnreachable = std::numeric_limits<double>::infinity();

/// The arcs and successions that a node of the search may still use, renumbered without gaps, so work shrinks
/// with their number. Arcs are in an order in which legs tend to go.
struct ResidualGraph {
    std::vector<int> arc;   ///< in the arc graph
    std::vector<int> tail;  ///< cone
    std::vector<int> head;
    std::vector<int> out_start;  ///< size() + 1
    std::vector<int> out_arc;    ///< successions: the next arc, in this graph
    std::vector<double> out_cost;
    std::vector<int> in_start;
    std::vector<int> in_arc;  ///< the arc before
    std::vector<double> in_cost;

    [[nodiscard]] int size() const { return static_cast<int>(arc.size()); }
    [[nodiscard]] int edge(int a) const { return arc[to_index(a)] / 2; }

    /// All arcs that can be reached from the starting ones, breadth first. Returns false, without arcs, if
    /// the clock expired.
    bool assign(const ArcGraph& graph, std::span<const char> starting_cone, SearchClock& clock);

    /// Keeps the arcs of `order` (arcs of `source`, in their new order) and the successions among them that
    /// `keep_successor` (by position in source.out_arc) marks. `index` is scratch.
    void filter(const ResidualGraph& source, std::span<const int> order, std::span<const char> keep_successor,
                std::vector<int>& index);

  private:
    bool collect(const ArcGraph& graph, std::span<const char> starting_cone, SearchClock& clock);
    bool index_predecessors(SearchClock* clock = nullptr);
};

}  // namespace conelane::path_pair
