#pragma once

#include "solvers/path_pair/graph/residual_graph.hpp"

namespace conelane::path_pair {

/// Depth-first search over simple legs without incompatible edges, cheapest continuation first; pruned if
/// cost so far + backward label >= cutoff.
class LegSearch {
  public:
    struct Query {
        const ArcGraph& graph;
        const ResidualGraph& residual;
        std::span<const double> reduced;
        std::span<const double> start;     ///< by arc, kUnreachable if no leg may start with it
        std::span<const double> end;       ///< by arc, kUnreachable if no leg may end with it
        std::span<const double> backward;  ///< lower bounds of the cost after each arc, `end` included
    };

    /// Calls `visit(leg, cost)` for every leg whose cost, with `end`, is below the cutoff; its result is the
    /// new cutoff. Returns false if `budget`, reduced by each arc tried, is used up.
    template <typename Visit>
    bool run(const Query& query, double cutoff, std::int64_t& budget, Visit&& visit) {
        open_.clear();
        leg_.clear();
        used_.assign(to_index(query.graph.cone_count()), 0);
        for (int a = 0; a < query.residual.size(); ++a) {
            const auto at = to_index(a);
            const double cost = query.start[at] + query.reduced[at];
            if (cost + query.backward[at] < cutoff) open_.push_back({a, 0, cost, cost + query.backward[at]});
        }
        sort_from(0);
        while (!open_.empty()) {
            const Step step = open_.back();
            open_.pop_back();
            while (leg_.size() > step.depth) retreat(query);
            if (step.bound >= cutoff) continue;
            if (--budget < 0) return false;
            if (!fits(query, step.arc)) continue;
            advance(query, step.arc);
            const auto at = to_index(step.arc);
            if (step.cost + query.end[at] < cutoff) {
                cutoff = visit(std::span<const int>(leg_), step.cost + query.end[at]);
            }
            const std::size_t first = open_.size();
            for (int position = query.residual.out_start[at]; position < query.residual.out_start[at + 1];
                 ++position) {
                const auto p = to_index(position);
                const auto next = to_index(query.residual.out_arc[p]);
                const double cost = step.cost + query.residual.out_cost[p] + query.reduced[next];
                const double bound = cost + query.backward[next];
                if (bound < cutoff) open_.push_back({static_cast<int>(next), leg_.size(), cost, bound});
            }
            sort_from(first);
        }
        return true;
    }

  private:
    struct Step {
        int arc;
        std::size_t depth;  ///< arcs of the leg before it
        double cost;
        double bound;
    };

    void sort_from(std::size_t first) {
        std::sort(open_.begin() + static_cast<std::ptrdiff_t>(first), open_.end(),
                  [](const Step& a, const Step& b) { return a.bound > b.bound; });
    }
    [[nodiscard]] bool fits(const Query& query, int arc) const {
        if (used_[to_index(query.residual.head[to_index(arc)])] != 0) {
            return false;
        }
        const int edge = query.residual.edge(arc);
        // The last edge shares an allowed turn with this one.
        for (std::size_t k = 0; k + 1 < leg_.size(); ++k) {
            if (query.graph.incompatible(edge, query.residual.edge(leg_[k]))) return false;
        }
        return true;
    }
    void advance(const Query& query, int arc) {
        const auto at = to_index(arc);
        if (leg_.empty()) used_[to_index(query.residual.tail[at])] = 1;
        used_[to_index(query.residual.head[at])] = 1;
        leg_.push_back(arc);
    }
    void retreat(const Query& query) {
        const auto at = to_index(leg_.back());
        leg_.pop_back();
        used_[to_index(query.residual.head[at])] = 0;
        if (leg_.empty()) used_[to_index(query.residual.tail[at])] = 0;
    }

    std::vector<Step> open_;
    std::vector<int> leg_;
    std::vector<char> used_;  ///< cones of the leg
};

}  // namespace conelane::path_pair
