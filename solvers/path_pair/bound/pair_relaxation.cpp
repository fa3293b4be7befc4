#include "solvers/path_pair/bound/pair_relaxation.hpp"

namespace conelane::path_pair {

void Decisions::reset(const ArcGraph& graph) {
    edge_.assign(to_index(graph.edge_count()), 0);
    edges_at_.assign(to_index(graph.cone_count()), 0);
    end_.assign(to_index(graph.cone_count()), End::open);
    visited_.assign(to_index(graph.cone_count()), 0);
    always_ = 0;
}

void Decisions::require_edge(const ArcGraph& graph, int edge) {
    edge_[to_index(edge)] = 1;
    for (const int cone : {graph.tail(2 * edge), graph.head(2 * edge)}) {
        ++edges_at_[to_index(cone)];
        ++visited_[to_index(cone)];
    }
}

void Decisions::decide_end(int cone, End decision) {
    const int change = (decision == End::always ? 1 : 0) - (end(cone) == End::always ? 1 : 0);
    always_ += change;
    visited_[to_index(cone)] += change;
    end_[to_index(cone)] = decision;
}

bool PairRelaxation::may_end(const ResidualGraph& residual, int kind, int arc) const {
    const int cone = residual.head[to_index(arc)];
    return system_.kinds[to_index(kind)].end[to_index(cone)] != 0 &&
           decisions_.end(cone) != Decisions::End::never && decisions_.may_be_last(cone, residual.edge(arc));
}

void PairRelaxation::reduce_arc_costs(const ResidualGraph& residual, const Multipliers& multipliers) {
    reduce(graph_, cliques_, multipliers, residual, edge_multiplier_, reduced_);
    for (double& cost : reduced_) cost -= cycle_margin_;
    for (int kind = 0; kind < system_.kind_count; ++kind) {
        std::vector<double>& start = legs_[to_index(kind)].start;
        start.resize(residual.arc.size());
        for (int a = 0; a < residual.size(); ++a) {
            const int cone = residual.tail[to_index(a)];
            start[to_index(a)] = system_.kinds[to_index(kind)].start[to_index(cone)] != 0 &&
                                         decisions_.may_be_last(cone, residual.edge(a))
                                     ? multipliers.cone[to_index(cone)]
                                     : kUnreachable;
        }
    }
}

double PairRelaxation::evaluate(const ResidualGraph& residual, Multipliers& multipliers) {
    reduce_arc_costs(residual, multipliers);
    for (int kind = 0; kind < system_.kind_count; ++kind) {
        Legs& legs = legs_[to_index(kind)];
        const bool bounded =
            bounds_.forward(residual, reduced_, legs.start, legs.forward, legs.before, cycles_);
        if (clock_.out_of_time(residual.out_arc.size())) return -kUnreachable;
        if (bounded) {
            pick_ends(residual, kind);
            continue;
        }
        raise_cycles(residual, cycles_, reduced_, multipliers.cone);
        reduce_arc_costs(residual, multipliers);
        kind = -1;  // the multipliers rose: all kinds again
    }
    offset_ = multipliers.offset();
    return combine() - offset_;
}

void PairRelaxation::pick_ends(const ResidualGraph& residual, int kind) {
    Legs& legs = legs_[to_index(kind)];
    legs.best.assign(to_index(graph_.cone_count()), kUnreachable);
    legs.best_arc.assign(to_index(graph_.cone_count()), -1);
    for (int a = 0; a < residual.size(); ++a) {
        const std::size_t cone = to_index(residual.head[to_index(a)]);
        if (legs.forward[to_index(a)] < legs.best[cone] && may_end(residual, kind, a)) {
            legs.best[cone] = legs.forward[to_index(a)];
            legs.best_arc[cone] = a;
        }
    }
}

double PairRelaxation::combine() {
    double bound = kUnreachable;
    ends_ = {-1, -1};
    if (!system_.ends_are_partners) {
        for (int kind = 0; kind < 2; ++kind) {
            const std::vector<double>& best = legs_[to_index(other(kind))].best;
            const auto least = std::ranges::min_element(best);
            legs_[to_index(kind)].rest.assign(best.size(), *least);
            ends_[to_index(other(kind))] = static_cast<int>(least - best.begin());
        }
        bound = legs_[0].rest[0] + legs_[1].rest[0];
        return bound;
    }
    for (int kind = 0; kind < system_.kind_count; ++kind) {
        Legs& legs = legs_[to_index(kind)];
        const std::vector<double>& best = legs_[to_index(other(kind))].best;
        legs.rest.assign(best.size(), kUnreachable);
        for (int cone = 0; cone < graph_.cone_count(); ++cone) {
            if (legs.best[to_index(cone)] == kUnreachable) continue;
            double& rest = legs.rest[to_index(cone)];
            int end = -1;
            for (const int partner : graph_.partners(cone)) {
                if (best[to_index(partner)] < rest && decisions_.ends_fit(cone, partner)) {
                    rest = best[to_index(partner)];
                    end = partner;
                }
            }
            if (legs.best[to_index(cone)] + rest < bound) {
                bound = legs.best[to_index(cone)] + rest;
                ends_[to_index(kind)] = cone;
                ends_[1 - to_index(kind)] = end;
            }
        }
    }
    return bound;
}

void PairRelaxation::evaluate_backward(const ResidualGraph& residual) {
    reachable_.resize(residual.arc.size());
    for (int kind = 0; kind < system_.kind_count; ++kind) {
        Legs& legs = legs_[to_index(kind)];
        legs.end.resize(residual.arc.size());
        for (int a = 0; a < residual.size(); ++a) {
            reachable_[to_index(a)] = legs.forward[to_index(a)] < kUnreachable ? 1 : 0;
            legs.end[to_index(a)] =
                may_end(residual, kind, a) ? legs.rest[to_index(residual.head[to_index(a)])] : kUnreachable;
        }
        bounds_.backward(residual, reduced_, legs.end, reachable_, legs.backward);
    }
}

void PairRelaxation::onward(const ResidualGraph& residual, int kind, std::vector<double>& label) {
    const Legs& legs = legs_[to_index(kind)];
    reachable_.resize(residual.arc.size());
    onward_end_.resize(residual.arc.size());
    for (int a = 0; a < residual.size(); ++a) {
        reachable_[to_index(a)] = legs.forward[to_index(a)] < kUnreachable ? 1 : 0;
        onward_end_[to_index(a)] = may_end(residual, kind, a) ? 0.0 : kUnreachable;
    }
    bounds_.backward(residual, reduced_, onward_end_, reachable_, label);
}

const std::array<std::vector<int>, 2>& PairRelaxation::walks() {
    for (int leg = 0; leg < 2; ++leg) {
        const Legs& legs = legs_[symmetric() ? 0 : to_index(leg)];
        walks_[to_index(leg)].clear();
        if (ends_[to_index(leg)] < 0) continue;
        for (int a = legs.best_arc[to_index(ends_[to_index(leg)])]; a >= 0; a = legs.before[to_index(a)]) {
            walks_[to_index(leg)].push_back(a);
        }
        std::ranges::reverse(walks_[to_index(leg)]);
    }
    return walks_;
}

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
    for (const std::vector<int>& walk : relaxation.walks()) {
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
