#include "solvers/path_pair/search/brancher.hpp"

namespace conelane::path_pair {

Branching Brancher::choose(const ResidualGraph& graph, const PairRelaxation& relaxation,
                           const Decisions& decisions, const WalkUsage& usage) const {
    Branching best{Branching::On::nothing, -1, 0.0};
    double best_score = -1.0;
    if (relaxation.symmetric()) {
        for (const int cone : relaxation.ends()) {
            if (cone < 0 || decisions.end(cone) != Decisions::End::open) continue;
            const double use = usage.ends()[to_index(cone)];
            if (use >= 1.0 - tuning_.min_end_doubt || use <= best_score) continue;
            best = {Branching::On::end, cone, use};
            best_score = use;
        }
        if (best.on != Branching::On::nothing) return best;
    }
    const auto doubt = [](double use) { return std::min(use, std::max(0.0, 1.0 - use)); };
    best_score = -1.0;
    for (int a = 0; a < graph.size(); ++a) {
        const int edge = graph.edge(a);
        const double use = usage.edges()[to_index(edge)];
        if (decisions.edge_required(edge) || doubt(use) <= best_score) continue;
        best = {Branching::On::edge, edge, use};
        best_score = doubt(use);
    }
    return best;
}

void Brancher::branch(const ResidualGraph& source, const Branching& branching, bool in,
                      ResidualGraph& target) {
    order_.clear();
    keep_successor_.assign(source.out_arc.size(), 1);
    if (branching.on == Branching::On::end) {
        branch_on_end(source, branching.what, in);
    } else {
        branch_on_edge(source, branching.what, in);
    }
    target.filter(source, order_, keep_successor_, index_);
}

void Brancher::branch_on_end(const ResidualGraph& source, int cone, bool in) {
    for (int a = 0; a < source.size(); ++a) {
        if (!in || source.tail[to_index(a)] != cone) order_.push_back(a);
    }
}

void Brancher::branch_on_edge(const ResidualGraph& source, int edge, bool in) {
    for (int a = 0; a < source.size(); ++a) {
        const int other = source.edge(a);
        if (!(in ? graph_.incompatible(edge, other) : other == edge)) order_.push_back(a);
    }
    if (!in) return;
    // A leg that comes to one of its cones goes on along it.
    const int ends[2] = {graph_.tail(2 * edge), graph_.head(2 * edge)};
    for (int a = 0; a < source.size(); ++a) {
        const int cone = source.head[to_index(a)];
        if ((cone != ends[0] && cone != ends[1]) || source.edge(a) == edge) continue;
        for (int p = source.out_start[to_index(a)]; p < source.out_start[to_index(a) + 1]; ++p) {
            if (source.edge(source.out_arc[to_index(p)]) != edge) keep_successor_[to_index(p)] = 0;
        }
    }
}

}  // namespace conelane::path_pair
