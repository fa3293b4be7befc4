#include "solvers/path_pair/primal/frontier_beam.hpp"

namespace conelane::path_pair {
namespace {

// Legs may turn back in the order of arcs, so arcs are gone through more than once.
constexpr int kMaxSweeps = 4;

}  // namespace

void FrontierBeam::run(const ResidualGraph& residual, std::size_t width) {
    residual_ = &residual;
    words_ = edges_.words();
    for (int kind = 0; kind < relaxation_.system().kind_count; ++kind) {
        relaxation_.onward(residual, kind, leg_onward_[to_index(kind)]);
    }
    labels_.reset(1);
    lost_.reset(words_);
    waiting_.assign(residual.arc.size(), -1);
    begin(width);
    again_ = true;
    for (int sweep = 0; again_ && sweep < kMaxSweeps; ++sweep) {
        again_ = false;
        for (settled_ = 0; settled_ < residual.size(); ++settled_) {
            if (waiting_[to_index(settled_)] < 0) continue;
            settle(settled_, width);
            if (clock_.expired()) return;
        }
    }
}

/// The most promising pairs of first arcs, some for each arc.
void FrontierBeam::begin(std::size_t width) {
    const ResidualGraph& r = *residual_;
    const int second = kind(1);
    const auto through = [&](int of_kind, int a) {
        return relaxation_.start(of_kind)[to_index(a)] + relaxation_.reduced()[to_index(a)] +
               leg_onward_[to_index(of_kind)][to_index(a)];
    };
    for (int a = 0; a < r.size(); ++a) {
        if (!(through(0, a) < kUnreachable)) continue;
        if (clock_.out_of_time(to_index(r.size()))) return;
        here_.clear();
        for (int b = relaxation_.symmetric() ? a + 1 : 0; b < r.size(); ++b) {
            if (!(through(0, a) + through(second, b) < limit())) continue;
            if (EdgeSets::contains(edges_.lost_after(a), edges_.number(b)) ||
                EdgeSets::contains(edges_.lost_before(a), edges_.number(b))) {
                continue;
            }
            here_.push_back(b);
        }
        const auto kept = std::min(here_.size(), width);
        std::partial_sort(here_.begin(), here_.begin() + static_cast<std::ptrdiff_t>(kept), here_.end(),
                          [&](int b, int c) { return through(second, b) < through(second, c); });
        for (std::size_t k = 0; k < kept; ++k) {
            const int b = here_[k];
            const double reduced = relaxation_.start(0)[to_index(a)] +
                                   relaxation_.start(second)[to_index(b)] +
                                   relaxation_.reduced()[to_index(b)];
            wait({.before = -1,
                  .moving = std::min(a, b),
                  .waiting = std::max(a, b),
                  .next = -1,
                  .moving_leg = static_cast<std::uint8_t>(a < b ? 0 : 1),
                  .ended = false,
                  .along_heading = static_cast<std::int8_t>(graph_.along_heading(r.edge(b)) ? 1 : 0),
                  .cost = graph_.cost(r.edge(b)),
                  .reduced = reduced,
                  .estimate = through(0, a) + through(second, b)},
                 edges_.lost_after(b), a);
        }
    }
}

/// Takes `arc` (-1 for none) and lets the label wait.
void FrontierBeam::wait(Label label, const std::uint64_t* lost_before, int arc) {
    clock_.out_of_time(20 + 2 * words_);
    std::uint64_t* const row = lost_.add();
    std::copy_n(lost_before, words_, row);
    if (arc >= 0) {
        const int edge = residual_->edge(arc);
        label.cost += graph_.cost(edge);
        label.reduced += relaxation_.reduced()[to_index(arc)];
        if (graph_.along_heading(edge)) {
            label.along_heading = static_cast<std::int8_t>(std::min(2, label.along_heading + 1));
        }
        const std::uint64_t* const more = edges_.lost_after(arc);
        for (std::size_t w = 0; w < words_; ++w) row[w] |= more[w];
    }
    label.next = std::exchange(waiting_[to_index(label.moving)], static_cast<int>(labels_.size()));
    again_ |= label.moving <= settled_;
    *labels_.add() = label;
}

void FrontierBeam::settle(int arc, std::size_t width) {
    here_.clear();
    for (int l = std::exchange(waiting_[to_index(arc)], -1); l >= 0; l = label_at(l).next) {
        if (label_at(l).estimate < limit()) here_.push_back(l);
    }
    clock_.out_of_time(50 * here_.size());
    // Cheapest first, by true costs: while the multipliers are far off, reduced ones favour two legs along
    // one boundary.
    const auto promise = [&](int l) {
        const Label& label = label_at(l);
        return label.estimate - label.reduced + label.cost;
    };
    std::sort(here_.begin(), here_.end(),
              [&](int a, int b) { return promise(a) != promise(b) ? promise(a) < promise(b) : a < b; });
    std::ptrdiff_t expanded = 0;
    for (std::size_t k = 0; k < here_.size() && expanded < static_cast<std::ptrdiff_t>(width); ++k) {
        const Label& label = label_at(here_[k]);
        const bool same_frontier = std::any_of(here_.begin(), here_.begin() + expanded, [&](int l) {
            return label_at(l).waiting == label.waiting && label_at(l).ended == label.ended;
        });
        if (same_frontier) continue;
        if (clock_.expired()) return;
        here_[to_index(static_cast<int>(expanded++))] = here_[k];
        expand(here_[k]);
    }
}

void FrontierBeam::expand(int l) {
    const ResidualGraph& r = *residual_;
    const Label label = label_at(l);
    const int moving_kind = kind(label.moving_leg);
    const auto other_leg = static_cast<std::uint8_t>(1 - label.moving_leg);
    const int other_kind = kind(other_leg);
    if (relaxation_.may_end(r, moving_kind, label.moving)) {
        if (label.ended) {
            if (label.cost < incumbent_.limit() && label.along_heading >= 2 &&
                relaxation_.ends_fit(r.head[to_index(label.moving)], r.head[to_index(label.waiting)])) {
                offer(l);
            }
        } else {
            Label on = label;
            on.before = l;
            on.moving = label.waiting;
            on.waiting = label.moving;
            on.moving_leg = other_leg;
            on.ended = true;
            on.estimate = label.reduced + leg_onward_[to_index(other_kind)][to_index(on.moving)];
            if (on.estimate < limit()) {
                lost_here_.assign(lost(l), lost(l) + words_);
                wait(on, lost_here_.data(), -1);
            }
        }
    }
    lost_here_.assign(lost(l), lost(l) + words_);
    const double rest = label.ended ? 0.0 : leg_onward_[to_index(other_kind)][to_index(label.waiting)];
    for (int p = r.out_start[to_index(label.moving)]; p < r.out_start[to_index(label.moving) + 1]; ++p) {
        const int arc = r.out_arc[to_index(p)];
        const double estimate = label.reduced + r.out_cost[to_index(p)] +
                                relaxation_.reduced()[to_index(arc)] +
                                leg_onward_[to_index(moving_kind)][to_index(arc)] + rest;
        if (!(estimate < limit()) || r.head[to_index(arc)] == r.head[to_index(label.waiting)] ||
            EdgeSets::contains(lost_here_.data(), edges_.number(arc))) {
            continue;
        }
        Label on = label;
        on.before = l;
        on.cost += r.out_cost[to_index(p)];
        on.reduced += r.out_cost[to_index(p)];
        on.estimate = estimate;
        if (label.ended || arc < label.waiting) {
            on.moving = arc;
        } else {
            on.moving = label.waiting;
            on.waiting = arc;
            on.moving_leg = other_leg;
        }
        wait(on, lost_here_.data(), arc);
    }
}

void FrontierBeam::offer(int label) {
    for (std::vector<int>& leg : legs_) leg.clear();
    for (int l = label; l >= 0; l = label_at(l).before) {
        const Label& here = label_at(l);
        const int last[2] = {here.moving_leg == 0 ? here.moving : here.waiting,
                             here.moving_leg == 0 ? here.waiting : here.moving};
        for (std::size_t leg = 0; leg < 2; ++leg) {
            const int arc = residual_->arc[to_index(last[leg])];
            if (legs_[leg].empty() || legs_[leg].back() != arc) legs_[leg].push_back(arc);
        }
    }
    for (std::vector<int>& leg : legs_) std::ranges::reverse(leg);
    incumbent_.offer(legs_[0], legs_[1]);
}

}  // namespace conelane::path_pair
