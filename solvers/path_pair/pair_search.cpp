#include "solvers/path_pair/pair_search.hpp"

#include <algorithm>

namespace conelane::path_pair {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

}  // namespace

void PairSearch::bind(const ArcGraph& graph, PairRelaxation& relaxation, Incumbent& incumbent) {
    graph_ = &graph;
    relaxation_ = &relaxation;
    incumbent_ = &incumbent;
}

double PairSearch::cutoff(double tolerance) const {
    return incumbent_->cutoff() - tolerance + relaxation_->offset();
}

void PairSearch::to_arcs(const ResidualGraph& residual, std::span<const int> leg,
                         std::vector<int>& arcs) const {
    arcs.clear();
    for (const int a : leg) arcs.push_back(residual.arc[at(a)]);
}

bool PairSearch::exhaust(const ResidualGraph& residual, double tolerance, std::int64_t budget) {
    for (int kind = 0; kind < relaxation_->system().kind_count; ++kind) {
        if (!exhaust_kind(residual, kind, tolerance, budget)) return false;
    }
    return true;
}

bool PairSearch::exhaust_kind(const ResidualGraph& residual, int kind, double tolerance,
                              std::int64_t& budget) {
    const PairRelaxation& r = *relaxation_;
    half_end_.resize(residual.arc.size());
    usable_.resize(residual.arc.size());
    for (int a = 0; a < residual.size(); ++a) {
        const double end = r.end(kind)[at(a)];
        usable_[at(a)] = r.forward(kind)[at(a)] < kUnreachable ? 1 : 0;
        half_end_[at(a)] =
            end < kUnreachable ? 0.5 * (end - r.best(kind, residual.head[at(a)])) : kUnreachable;
    }
    bounds_.backward(residual, r.reduced(), half_end_, usable_, half_backward_);
    const LegSearch::Query query{*graph_, residual, r.reduced(), r.start(kind), half_end_, half_backward_};
    bool complete = true;
    const bool all =
        first_search_.run(query, 0.5 * cutoff(tolerance), budget, [&](std::span<const int> leg, double cost) {
            const double own_cost = cost - half_end_[at(leg.back())];
            if (!second_legs(residual, kind, leg, own_cost, tolerance, budget)) {
                complete = false;
                return -kUnreachable;
            }
            return 0.5 * cutoff(tolerance);
        });
    return all && complete;
}

bool PairSearch::second_legs(const ResidualGraph& residual, int kind, std::span<const int> first,
                             double first_cost, double tolerance, std::int64_t& budget) {
    const PairRelaxation& r = *relaxation_;
    const int second_kind = r.other(kind);
    taken_.assign(at(graph_->cone_count()), 0);
    blocked_.assign((at(graph_->edge_count()) + 63) / 64, 0);
    taken_[at(residual.tail[at(first.front())])] = 1;
    for (const int a : first) {
        taken_[at(residual.head[at(a)])] = 1;
        const std::span<const std::uint64_t> row = graph_->incompatible_row(residual.edge(a));
        for (std::size_t w = 0; w < blocked_.size(); ++w) blocked_[w] |= row[w];
    }
    const int first_end = residual.head[at(first.back())];
    usable_.resize(residual.arc.size());
    second_end_.resize(residual.arc.size());
    second_start_.resize(residual.arc.size());
    for (int a = 0; a < residual.size(); ++a) {
        const int edge = residual.edge(a);
        const int head = residual.head[at(a)];
        const bool usable = taken_[at(head)] == 0 && taken_[at(residual.tail[at(a)])] == 0 &&
                            (blocked_[at(edge) / 64] >> (at(edge) % 64) & 1) == 0 &&
                            r.forward(second_kind)[at(a)] < kUnreachable;
        usable_[at(a)] = usable ? 1 : 0;
        second_end_[at(a)] = usable && r.may_end(residual, second_kind, a) &&
                 r.ends_fit(first_end, head)
                                 ? 0.0
                                 : kUnreachable;
        second_start_[at(a)] = usable ? r.start(second_kind)[at(a)] : kUnreachable;
    }
    bounds_.backward(residual, r.reduced(), second_end_, usable_, second_backward_);
    budget -= 8 + residual.size();
    to_arcs(residual, first, first_arcs_);
    best_second_.clear();
    const LegSearch::Query query{*graph_,       residual,    r.reduced(),
                                 second_start_, second_end_, second_backward_};
    return second_search_.run(query, cutoff(tolerance) - first_cost, budget,
                              [&](std::span<const int> leg, double) {
                                  to_arcs(residual, leg, second_arcs_);
                                  if (incumbent_->offer(first_arcs_, second_arcs_)) {
                                      best_second_.assign(leg.begin(), leg.end());
                                  }
                                  return cutoff(tolerance) - first_cost;
                              });
}

bool PairSearch::is_leg(const ResidualGraph& residual, std::span<const int> walk) {
    taken_.assign(at(graph_->cone_count()), 0);
    taken_[at(residual.tail[at(walk.front())])] = 1;
    for (std::size_t k = 0; k < walk.size(); ++k) {
        char& taken = taken_[at(residual.head[at(walk[k])])];
        if (taken != 0) return false;
        taken = 1;
        for (std::size_t l = 0; l + 1 < k; ++l) {
            if (graph_->incompatible(residual.edge(walk[k]), residual.edge(walk[l]))) return false;
        }
    }
    return true;
}

void PairSearch::complete(const ResidualGraph& residual, int kind, std::span<const int> walk,
                          double tolerance, std::int64_t budget) {
    if (walk.empty()) return;
    const PairRelaxation& r = *relaxation_;
    if (is_leg(residual, walk)) {
        leg_.assign(walk.begin(), walk.end());
    } else {
        leg_.clear();
        const LegSearch::Query query{*graph_,       residual,    r.reduced(),
                                     r.start(kind), r.end(kind), r.backward(kind)};
        std::int64_t tries = budget;
        first_search_.run(query, cutoff(tolerance), tries, [&](std::span<const int> leg, double cost) {
            leg_.assign(leg.begin(), leg.end());
            return cost;
        });
        if (leg_.empty()) return;
    }
    for (int side = 0; side < 3; ++side) {
        double cost = r.start(kind)[at(leg_.front())];
        for (std::size_t k = 0; k < leg_.size(); ++k) {
            cost += r.reduced()[at(leg_[k])];
            if (k > 0) {
                cost += graph_->turn_cost(residual.arc[at(leg_[k - 1])], residual.arc[at(leg_[k])]);
            }
        }
        std::int64_t tries = budget;
        second_legs(residual, kind, leg_, cost, tolerance, tries);
        if (best_second_.empty()) return;
        leg_ = best_second_;
        kind = r.other(kind);
    }
}

}  // namespace conelane::path_pair
