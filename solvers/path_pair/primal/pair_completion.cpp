#include "solvers/path_pair/primal/pair_completion.hpp"

#include "solvers/path_pair/graph/to_index.hpp"

#include <algorithm>

namespace conelane::path_pair {
namespace {

constexpr int kSecondRounds = 4;  ///< of the multipliers' ascent, before the second leg is searched

}  // namespace

void PairCompletion::bind(const ArcGraph& graph, PairRelaxation& relaxation, Incumbent& incumbent,
                          SearchClock& clock) {
    graph_ = &graph;
    clock_ = &clock;
    bounds_.bind(clock);
    relaxation_ = &relaxation;
    incumbent_ = &incumbent;
    second_multiplier_.assign(to_index(graph.cone_count()), 0.0);
    second_before_.clear();
}

double PairCompletion::cutoff(double tolerance) const {
    return incumbent_->cutoff() - tolerance + relaxation_->offset();
}

void PairCompletion::to_arcs(const ResidualGraph& residual, std::span<const int> leg,
                             std::vector<int>& arcs) const {
    arcs.clear();
    for (const int a : leg) arcs.push_back(residual.arc[to_index(a)]);
}

void PairCompletion::leave_out(const ResidualGraph& residual, int second_kind, std::span<const int> first) {
    const PairRelaxation& r = *relaxation_;
    taken_.assign(to_index(graph_->cone_count()), 0);
    blocked_.assign((to_index(graph_->edge_count()) + 63) / 64, 0);
    taken_[to_index(residual.tail[to_index(first.front())])] = 1;
    for (const int a : first) {
        taken_[to_index(residual.head[to_index(a)])] = 1;
        const std::span<const std::uint64_t> row = graph_->incompatible_row(residual.edge(a));
        for (std::size_t w = 0; w < blocked_.size(); ++w) blocked_[w] |= row[w];
    }
    const int first_end = residual.head[to_index(first.back())];
    usable_.resize(residual.arc.size());
    second_end_.resize(residual.arc.size());
    for (int a = 0; a < residual.size(); ++a) {
        const int edge = residual.edge(a);
        const int head = residual.head[to_index(a)];
        const bool usable = taken_[to_index(head)] == 0 &&
                            taken_[to_index(residual.tail[to_index(a)])] == 0 &&
                            (blocked_[to_index(edge) / 64] >> (to_index(edge) % 64) & 1) == 0 &&
                            r.forward(second_kind)[to_index(a)] < kUnreachable;
        usable_[to_index(a)] = usable ? 1 : 0;
        second_end_[to_index(a)] =
            usable && r.may_end(residual, second_kind, a) && r.ends_fit(first_end, head) ? 0.0 : kUnreachable;
    }
}

double PairCompletion::reduce_second_costs(const ResidualGraph& residual, int second_kind) {
    const PairRelaxation& r = *relaxation_;
    second_reduced_.resize(residual.arc.size());
    second_start_.resize(residual.arc.size());
    for (int a = 0; a < residual.size(); ++a) {
        if (usable_[to_index(a)] == 0) {
            second_reduced_[to_index(a)] = second_start_[to_index(a)] = kUnreachable;
            continue;
        }
        second_reduced_[to_index(a)] =
            graph_->cost(residual.edge(a)) + second_multiplier_[to_index(residual.head[to_index(a)])];
        second_start_[to_index(a)] = r.start(second_kind)[to_index(a)] < kUnreachable
                                         ? second_multiplier_[to_index(residual.tail[to_index(a)])]
                                         : kUnreachable;
    }
    double offset = 0.0;
    for (std::size_t cone = 0; cone < taken_.size(); ++cone) {
        if (taken_[cone] == 0) offset += second_multiplier_[cone];
    }
    return offset;
}

bool PairCompletion::second_legs(const ResidualGraph& residual, int kind, std::span<const int> first,
                                 double tolerance, std::int64_t& budget) {
    const int second_kind = relaxation_->other(kind);
    leave_out(residual, second_kind, first);
    to_arcs(residual, first, first_arcs_);
    const double first_cost = incumbent_->leg_cost(first_arcs_);
    best_second_.clear();
    const auto limit = [&] { return incumbent_->cutoff() - tolerance - first_cost; };
    const auto offer = [&](std::span<const int> leg) {
        to_arcs(residual, leg, second_arcs_);
        if (incumbent_->offer(first_arcs_, second_arcs_)) best_second_.assign(leg.begin(), leg.end());
    };
    double offset = 0.0;
    for (int round = 0; round < kSecondRounds;) {
        offset = reduce_second_costs(residual, second_kind);
        budget -= residual.size();
        const bool bounded = bounds_.forward(residual, second_reduced_, second_start_, second_forward_,
                                             second_before_, cycles_);
        if (clock_->out_of_time(residual.out_arc.size())) return false;
        if (!bounded) {
            raise_cycles(residual, cycles_, second_reduced_, second_multiplier_);
            continue;
        }
        ++round;
        int end = -1;
        for (int a = 0; a < residual.size(); ++a) {
            if (second_end_[to_index(a)] < kUnreachable &&
                (end < 0 || second_forward_[to_index(a)] < second_forward_[to_index(end)])) {
                end = a;
            }
        }
        if (end < 0 || second_forward_[to_index(end)] - offset >= limit()) return true;
        const double value = second_forward_[to_index(end)] - offset;
        second_walk_.clear();
        for (int a = end; a >= 0; a = second_before_[to_index(a)]) second_walk_.push_back(a);
        std::ranges::reverse(second_walk_);
        offer(second_walk_);
        if (value >= limit()) return true;
        // A step towards one visit of every cone that has a multiplier.
        visits_.assign(taken_.size(), 0);
        ++visits_[to_index(residual.tail[to_index(second_walk_.front())])];
        for (const int a : second_walk_) ++visits_[to_index(residual.head[to_index(a)])];
        double squared = 0.0;
        for (std::size_t cone = 0; cone < taken_.size(); ++cone) {
            if (taken_[cone] != 0 || (second_multiplier_[cone] <= 0.0 && visits_[cone] < 2)) continue;
            squared += (visits_[cone] - 1) * (visits_[cone] - 1);
        }
        if (squared == 0.0 || round == kSecondRounds) break;
        const double length = (limit() - value) / squared;
        for (std::size_t cone = 0; cone < taken_.size(); ++cone) {
            if (taken_[cone] != 0 || (second_multiplier_[cone] <= 0.0 && visits_[cone] < 2)) continue;
            second_multiplier_[cone] = std::max(0.0, second_multiplier_[cone] + length * (visits_[cone] - 1));
        }
    }
    // Cycles that no leg reaches may still have a negative cost.
    for (int a = 0; a < residual.size(); ++a) {
        if (second_forward_[to_index(a)] == kUnreachable) usable_[to_index(a)] = 0;
    }
    bounds_.backward(residual, second_reduced_, second_end_, usable_, second_backward_);
    if (clock_->out_of_time(residual.out_arc.size())) return false;
    const LegSearch::Query query{*graph_,       residual,    second_reduced_,
                                 second_start_, second_end_, second_backward_};
    return second_search_.run(query, limit() + offset, budget, [&](std::span<const int> leg, double) {
        offer(leg);
        return limit() + offset;
    });
}

bool PairCompletion::is_leg(const ResidualGraph& residual, std::span<const int> walk) {
    taken_.assign(to_index(graph_->cone_count()), 0);
    taken_[to_index(residual.tail[to_index(walk.front())])] = 1;
    for (std::size_t k = 0; k < walk.size(); ++k) {
        char& taken = taken_[to_index(residual.head[to_index(walk[k])])];
        if (taken != 0) return false;
        taken = 1;
        for (std::size_t l = 0; l + 1 < k; ++l) {
            if (graph_->incompatible(residual.edge(walk[k]), residual.edge(walk[l]))) return false;
        }
    }
    return true;
}

void PairCompletion::complete(const ResidualGraph& residual, int kind, std::span<const int> walk,
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
        if (clock_->out_of_time()) return;
        std::int64_t tries = budget;
        second_legs(residual, kind, leg_, tolerance, tries);
        if (best_second_.empty()) return;
        leg_ = best_second_;
        kind = r.other(kind);
    }
}

}  // namespace conelane::path_pair
