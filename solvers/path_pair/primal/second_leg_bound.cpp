#include "solvers/path_pair/primal/second_leg_bound.hpp"

namespace conelane::path_pair {

void SecondLegBound::reset() {
    multipliers_.cone.assign(to_index(graph_.cone_count()), 0.0);
    none_required_.assign(to_index(graph_.cone_count()), 0);
    before_.clear();
}

void SecondLegBound::assign(const PairRelaxation& relaxation, const ResidualGraph& residual, int kind,
                            std::span<const int> first) {
    relaxation_ = &relaxation;
    residual_ = &residual;
    kind_ = kind;
    leave_out(first);
    const int first_end = residual.head[to_index(first.back())];
    usable_.resize(residual.arc.size());
    end_.resize(residual.arc.size());
    for (int a = 0; a < residual.size(); ++a) {
        const int edge = residual.edge(a);
        const int head = residual.head[to_index(a)];
        const bool usable = taken_[to_index(head)] == 0 &&
                            taken_[to_index(residual.tail[to_index(a)])] == 0 &&
                            (blocked_[to_index(edge) / 64] >> (to_index(edge) % 64) & 1) == 0 &&
                            relaxation.forward(kind)[to_index(a)] < kUnreachable;
        usable_[to_index(a)] = usable ? 1 : 0;
        end_[to_index(a)] =
            usable && relaxation.may_end(residual, kind, a) && relaxation.ends_fit(first_end, head)
                ? 0.0
                : kUnreachable;
    }
}

void SecondLegBound::leave_out(std::span<const int> first) {
    taken_.assign(to_index(graph_.cone_count()), 0);
    blocked_.assign((to_index(graph_.edge_count()) + 63) / 64, 0);
    taken_[to_index(residual_->tail[to_index(first.front())])] = 1;
    for (const int a : first) {
        taken_[to_index(residual_->head[to_index(a)])] = 1;
        const std::span<const std::uint64_t> row = graph_.incompatible_row(residual_->edge(a));
        for (std::size_t w = 0; w < blocked_.size(); ++w) blocked_[w] |= row[w];
    }
}

void SecondLegBound::reduce_costs() {
    const std::vector<double>& multiplier = multipliers_.cone;
    const std::span<const double> start = relaxation_->start(kind_);
    reduced_.resize(residual_->arc.size());
    start_.resize(residual_->arc.size());
    for (int a = 0; a < residual_->size(); ++a) {
        if (usable_[to_index(a)] == 0) {
            reduced_[to_index(a)] = start_[to_index(a)] = kUnreachable;
            continue;
        }
        reduced_[to_index(a)] =
            graph_.cost(residual_->edge(a)) + multiplier[to_index(residual_->head[to_index(a)])];
        start_[to_index(a)] = start[to_index(a)] < kUnreachable
                                  ? multiplier[to_index(residual_->tail[to_index(a)])]
                                  : kUnreachable;
    }
    offset_ = 0.0;
    for (std::size_t cone = 0; cone < taken_.size(); ++cone) {
        if (taken_[cone] == 0) offset_ += multiplier[cone];
    }
}

bool SecondLegBound::evaluate(std::int64_t& budget) {
    while (true) {
        reduce_costs();
        budget -= residual_->size();
        const bool bounded = bounds_.forward(*residual_, reduced_, start_, forward_, before_, cycles_);
        if (clock_.out_of_time(residual_->out_arc.size())) return false;
        if (bounded) break;
        raise_cycles(*residual_, cycles_, reduced_, multipliers_.cone);
    }
    take_cheapest_walk();
    return true;
}

void SecondLegBound::take_cheapest_walk() {
    int end = -1;
    for (int a = 0; a < residual_->size(); ++a) {
        if (end_[to_index(a)] < kUnreachable &&
            (end < 0 || forward_[to_index(a)] < forward_[to_index(end)])) {
            end = a;
        }
    }
    walk_.clear();
    value_ = end < 0 ? kUnreachable : forward_[to_index(end)] - offset_;
    if (value_ == kUnreachable) return;
    for (int a = end; a >= 0; a = before_[to_index(a)]) walk_.push_back(a);
    std::ranges::reverse(walk_);
}

bool SecondLegBound::step(double target) {
    usage_.along_heading = 2;  // of no concern, as are the cones of the first leg
    usage_.cone.assign(taken_.begin(), taken_.end());
    ++usage_.cone[to_index(residual_->tail[to_index(walk_.front())])];
    for (const int a : walk_) ++usage_.cone[to_index(residual_->head[to_index(a)])];
    ascent_.restart(multipliers_);
    return ascent_.step(multipliers_, usage_, none_required_, target - value_, 1.0);
}

bool SecondLegBound::evaluate_backward() {
    // Cycles that no leg reaches may still have a negative cost.
    for (int a = 0; a < residual_->size(); ++a) {
        if (forward_[to_index(a)] == kUnreachable) usable_[to_index(a)] = 0;
    }
    bounds_.backward(*residual_, reduced_, end_, usable_, backward_);
    return !clock_.out_of_time(residual_->out_arc.size());
}

}  // namespace conelane::path_pair
