#include "solvers/path_pair/frontier/frontier_graph.hpp"

#include <bit>

namespace conelane::path_pair {
namespace {

constexpr int kNotOpen = -2;
constexpr std::size_t kFewSlots = 1024;
/// Extending a frontier takes as long as looking at this many.
constexpr std::size_t kFrontiersPerExtension = 4;
constexpr std::size_t kWorkPerFrontier = 200;  ///< in steps of the clock
/// Room is made for so many, and for steps, before the first one. Memory that is not written to costs
/// nothing.
constexpr std::size_t kReservedFrontiers = std::size_t{1} << 18U;
constexpr std::size_t kMaxFirstFrontiers = 1'000'000;
constexpr std::size_t kMaxFirstWords = 40'000'000;  ///< of 8 bytes, of their sets of edges
constexpr int kFewFrontiers = 3000;    ///< With more, the bounds of partners are worth their time.
constexpr int kMaxPartnerArcs = 4000;  ///< of their tables, which grow with arcs and ends

}  // namespace

std::uint64_t FrontierGraph::key(const Frontier& frontier) {
    return (static_cast<std::uint64_t>(frontier.moving) << 32) +
           (static_cast<std::uint64_t>(frontier.waiting) << 2) + (frontier.moving_kind == 1 ? 2U : 0U) +
           (frontier.ended ? 1U : 0U);
}

bool FrontierGraph::out_of_time(std::size_t frontiers) {
    return clock_.tick(kWorkPerFrontier * frontiers);
}

bool FrontierGraph::fill_dominated(std::size_t words) {
    dominated_.reset(words);
    for (int f = 0; f < size(); ++f) {
        if (out_of_time()) return false;
        std::fill_n(dominated_.add(), words, ~std::uint64_t{0});
    }
    return true;
}

void FrontierGraph::forget_frontiers() {
    now_.clear();
    starts_.clear();
}

double FrontierGraph::start_cost(int f) const {
    const Frontier& start = frontier(f);
    const int kind = start.moving_kind;
    const int other = relaxation_.other(kind);
    return relaxation_.start(kind)[to_index(start.moving)] + relaxation_.reduced()[to_index(start.moving)] +
           relaxation_.start(other)[to_index(start.waiting)] + relaxation_.reduced()[to_index(start.waiting)];
}

bool FrontierGraph::grow_table() {
    if (!fill(table_, std::max(kFewSlots, table_.size() * 2), -1)) return false;
    for (int f = 0; f < size(); ++f) {
        if (out_of_time()) return false;
        std::size_t slot = (key(frontier(f)) * 0x9E3779B97F4A7C15U >> 32) & (table_.size() - 1);
        while (table_[slot] >= 0) slot = (slot + 1) & (table_.size() - 1);
        table_[slot] = f;
    }
    return true;
}

/// The frontier's number, new or known. Any number once the time has ended: then all frontiers are dropped.
int FrontierGraph::number(const Frontier& wanted) {
    if (2 * (now_.frontiers.size() + 1) > table_.size() && !grow_table()) return 0;
    // Fibonacci hashing: the upper half depends on all bits.
    std::size_t slot = (key(wanted) * 0x9E3779B97F4A7C15U >> 32) & (table_.size() - 1);
    for (; table_[slot] >= 0; slot = (slot + 1) & (table_.size() - 1)) {
        if (frontier(table_[slot]) == wanted) return table_[slot];
    }
    if (!make_room(now_.frontiers, 1) || !make_room(now_.forward, 1) || !make_room(now_.begin, 1) ||
        !make_room(now_.end, 1) || !make_room(next_open_, 1)) {
        return 0;
    }
    table_[slot] = size();
    now_.frontiers.push_back(wanted);
    now_.forward.push_back(kUnreachable);
    now_.begin.push_back(0);
    now_.end.push_back(0);  // no steps yet: the first one is at 1 or later
    next_open_.push_back(kNotOpen);
    if (edges_ != nullptr) std::fill_n(dominated_.add(), edges_->words(), ~std::uint64_t{0});
    return size() - 1;
}

/// The first frontiers below the limit.
void FrontierGraph::begin(double limit) {
    const ResidualGraph& r = *residual_;
    const bool symmetric = relaxation_.symmetric();
    const int second = relaxation_.other(0);
    const auto cost = [&](int kind, int a) {
        return relaxation_.start(kind)[to_index(a)] + relaxation_.reduced()[to_index(a)];
    };
    const std::size_t words = edges_ == nullptr ? 0 : edges_->words();
    max_first_ = std::min(kMaxFirstFrontiers, kMaxFirstWords / std::max<std::size_t>(words, 1));
    stack_.clear();  // arcs that a leg of the second kind may start with
    for (int b = 0; b < r.size(); ++b) {
        if (cost(second, b) < kUnreachable) stack_.push_back(b);
    }
    for (int a = 0; a < r.size(); ++a) {
        if (cost(0, a) == kUnreachable) continue;
        if (now_.frontiers.size() > max_first_ || out_of_time() || clock_.tick(stack_.size())) break;
        for (const int b : stack_) {
            const double start = cost(0, a) + cost(second, b);
            if (!(start + leg_onward_[0][to_index(a)] + leg_onward_[to_index(second)][to_index(b)] < limit))
                continue;
            if ((symmetric && b <= a) || r.head[to_index(a)] == r.head[to_index(b)] ||
                !dominated_of_arcs_->may_pair(0, a, second, b, false)) {
                continue;
            }
            if (now_.frontiers.size() > max_first_ || clock_.tick(2 * words)) break;
            const int f = number(a < b ? Frontier{a, b, 0, false}
                                       : Frontier{b, a, static_cast<std::uint8_t>(second), false});
            now_.forward[to_index(f)] = start;
            starts_.push_back(f);
            if (edges_ != nullptr) {
                intersect_with_union(dominated_.row(to_index(f)), edges_->lost_after(a),
                                     edges_->lost_after(b), words);
            }
            open(f);
        }
    }
    stack_.clear();
}

FrontierGraph::Frontier FrontierGraph::after(const Frontier& frontier, int arc, std::uint8_t other) {
    if (arc < 0) return {frontier.waiting, frontier.moving, other, true};
    if (frontier.ended || arc < frontier.waiting)
        return {arc, frontier.waiting, frontier.moving_kind, frontier.ended};
    return {frontier.waiting, arc, other, false};
}

/// All steps of a frontier; their next frontiers are not extended yet. None once the time has ended.
void FrontierGraph::add_steps(int f, double limit) {
    const ResidualGraph& r = *residual_;
    const Frontier here = frontier(f);
    const int kind = here.moving_kind;
    const int other = relaxation_.other(kind);
    const std::span<const double> reduced = relaxation_.reduced();
    const std::span<const double> onward = leg_onward_[to_index(kind)];
    const double forward = relaxation_.forward(kind)[to_index(here.moving)];
    const double waiting = relaxation_.forward(other)[to_index(here.waiting)] +
                           (here.ended ? 0.0 : leg_onward_[to_index(other)][to_index(here.waiting)]);
    const int waiting_cone = r.head[to_index(here.waiting)];
    const int ways = r.out_start[to_index(here.moving) + 1] - r.out_start[to_index(here.moving)];
    if (!make_room(now_.steps, to_index(ways) + 1)) return;
    now_.begin[to_index(f)] = now_.steps.size();
    for (int p = r.out_start[to_index(here.moving)]; p < r.out_start[to_index(here.moving) + 1]; ++p) {
        const int next = r.out_arc[to_index(p)];
        const double moving =
            forward + r.out_cost[to_index(p)] + reduced[to_index(next)] + onward[to_index(next)];
        if (!(moving + waiting < limit) || r.head[to_index(next)] == waiting_cone ||
            !dominated_of_arcs_->may_follow(kind, here.moving, next) ||
            !dominated_of_arcs_->may_pair(kind, next, other, here.waiting, here.ended)) {
            continue;
        }
        now_.steps.push_back({-1, next, r.out_cost[to_index(p)]});
    }
    if (!here.ended && relaxation_.may_end(r, kind, here.moving)) now_.steps.push_back({-1, -1, 0.0});
    now_.end[to_index(f)] = now_.steps.size();
}

bool FrontierGraph::build(const ResidualGraph& residual, const DominatedEdges& dominated, double limit,
                          std::size_t max_frontiers, const EdgeSets* edges) {
    if (clock_.out_of_time()) return false;
    residual_ = &residual;
    edges_ = edges;
    dominated_.reset(edges_ == nullptr ? 0 : edges_->words());
    if (edges_ != nullptr) nothing_.assign(edges_->words(), 0);
    dominated_of_arcs_ = &dominated;
    for (int kind = 0; kind < relaxation_.system().kind_count; ++kind) {
        relaxation_.onward(residual, kind, leg_onward_[to_index(kind)]);
    }
    now_.clear();
    now_.reserve(std::min(kReservedFrontiers, max_frontiers));
    next_open_.clear();
    next_open_.reserve(std::min(kReservedFrontiers, max_frontiers));
    now_.steps.push_back({-1, -1, 0.0});  // so that no frontier's steps begin at 0
    starts_.clear();
    open_at_.assign(residual.arc.size(), -1);
    open_arcs_.assign((residual.arc.size() + 63) / 64, 0);
    moving_ = 0;
    has_partners_ = false;
    table_.assign(kFewSlots, -1);
    begin(limit);
    if (clock_.expired() || now_.frontiers.size() > max_first_) {
        stack_.clear();
        return false;
    }
    // Arc by arc: steps lead to frontiers whose moving arc mostly comes later.
    for (again_ = true; again_;) {
        again_ = false;
        for (std::size_t word = 0; word < open_arcs_.size(); ++word) {
            while (open_arcs_[word] != 0) {
                moving_ = static_cast<int>(word * 64) + std::countr_zero(open_arcs_[word]);
                open_arcs_[word] &= open_arcs_[word] - 1;
                for (int f = std::exchange(open_at_[to_index(moving_)], -1); f >= 0;) {
                    const int next = std::exchange(next_open_[to_index(f)], kNotOpen);
                    if (out_of_time(kFrontiersPerExtension) || !extend(f, limit, max_frontiers)) return false;
                    f = next;
                }
            }
        }
    }
    order();
    return !clock_.expired();
}

void FrontierGraph::open(int f) {
    if (next_open_[to_index(f)] != kNotOpen) return;
    const std::size_t arc = to_index(frontier(f).moving);
    next_open_[to_index(f)] = std::exchange(open_at_[arc], f);
    open_arcs_[arc / 64] |= std::uint64_t{1} << (arc % 64);
    again_ |= arc / 64 < to_index(moving_) / 64;
}

/// Every walk up to a frontier loses these edges: one more walk comes to `to`. True if the set shrinks.
bool FrontierGraph::narrow_dominated(int from, int to, int arc) {
    if (edges_ == nullptr) return false;
    const std::size_t words = edges_->words();
    const std::uint64_t* const own = arc < 0 ? nothing_.data() : edges_->lost_after(arc);
    return intersect_with_union(dominated_.row(to_index(to)), dominated_.row(to_index(from)), own, words);
}

bool FrontierGraph::may_pass(const Frontier& frontier, double forward, double limit) const {
    if (!has_partners_) return true;
    return forward + (frontier.ended ? partners_.onward_to_partner(frontier.moving, frontier.waiting)
                                     : partners_.onward(frontier.moving, frontier.waiting)) <
           limit;
}

/// Lowers the forward costs of the frontiers after this one. False if there are too many.
bool FrontierGraph::extend(int f, double limit, std::size_t max_frontiers) {
    const Frontier here = frontier(f);
    const int other = relaxation_.other(here.moving_kind);
    const std::span<const double> reduced = relaxation_.reduced();
    const std::span<const double> leg_onward = leg_onward_[to_index(here.moving_kind)];
    const double forward = now_.forward[to_index(f)];
    const double waiting = here.ended ? 0.0 : leg_onward_[to_index(other)][to_index(here.waiting)];
    if (!(forward + leg_onward[to_index(here.moving)] + waiting < limit)) return true;
    if (now_.end[to_index(f)] == 0) {
        if (!has_partners_ && size() > kFewFrontiers && residual_->size() <= kMaxPartnerArcs &&
            relaxation_.symmetric() && relaxation_.system().ends_are_partners) {
            if (!partners_.find(relaxation_, *residual_, limit, clock_)) return false;
            has_partners_ = true;
        }
        if (!may_pass(here, forward, limit)) return true;
        add_steps(f, limit);
    }
    for (std::size_t p = now_.begin[to_index(f)]; p < now_.end[to_index(f)]; ++p) {
        const auto [known, arc, turn] = now_.steps[p];
        if (edges_ != nullptr && arc >= 0 &&
            EdgeSets::contains(dominated_.row(to_index(f)), edges_->number(arc))) {
            continue;
        }
        const double label = forward + (turn + (arc < 0 ? 0.0 : reduced[to_index(arc)]));
        const double on = arc < 0 ? 0.0 : leg_onward[to_index(arc)];
        if (!(label + on + waiting < limit)) continue;
        int to = known;
        if (to < 0) {
            const Frontier next = after(here, arc, static_cast<std::uint8_t>(other));
            if (!may_pass(next, label, limit)) continue;
            now_.steps[p].to = to = number(next);
            if (now_.frontiers.size() > max_frontiers) return false;
        }
        const bool narrowed = narrow_dominated(f, to, arc);
        const bool cheaper = is_cheaper(label, now_.forward[to_index(to)]);
        if (cheaper) now_.forward[to_index(to)] = label;
        if (cheaper || narrowed) open(to);
    }
    return true;
}

/// Numbers the frontiers that have steps or are last again, in reversed finishing order of a depth-first
/// search: nearly every step then leads to a later frontier.
void FrontierGraph::order() {
    if (!order_frontiers()) return forget_frontiers();
    const ResidualGraph& r = *residual_;
    for (const Frontier& f : now_.frontiers) {
        if (out_of_time()) return forget_frontiers();
        const bool last = f.ended && relaxation_.may_end(r, f.moving_kind, f.moving) &&
                          relaxation_.ends_fit(r.head[to_index(f.moving)], r.head[to_index(f.waiting)]);
        now_.last.push_back(last ? 1 : 0);
    }
    if (!fill(now_.onward, now_.frontiers.size(), kUnreachable) ||
        !fill(keep_step_, now_.steps.size(), char{1})) {
        return forget_frontiers();
    }
    keep(order_);
}

bool FrontierGraph::order_frontiers() {
    order_.clear();
    order_.reserve(now_.frontiers.size());
    if (!fill(index_, now_.frontiers.size(), -1) ||
        !fill(next_step_, now_.frontiers.size(), std::size_t{0})) {
        return false;
    }
    const auto enter = [&](int f) {
        if (f < 0 || now_.end[to_index(f)] == 0 || index_[to_index(f)] >= 0) return;
        index_[to_index(f)] = 0;
        next_step_[to_index(f)] = now_.begin[to_index(f)];
        stack_.push_back(f);
    };
    for (const int start : starts_) {
        enter(start);
        while (!stack_.empty()) {
            if (out_of_time()) {
                stack_.clear();
                return false;
            }
            const int f = stack_.back();
            if (next_step_[to_index(f)] == now_.end[to_index(f)]) {
                order_.push_back(f);
                stack_.pop_back();
            } else {
                enter(now_.steps[next_step_[to_index(f)]++].to);
            }
        }
    }
    std::ranges::reverse(order_);
    return true;
}

/// Numbers the frontiers again: those not in `order` are dropped, and so are steps not marked in keep_step_.
void FrontierGraph::keep(std::span<const int> order) {
    std::swap(now_, old_);
    now_.clear();
    now_.reserve(order.size());
    now_.steps.reserve(old_.steps.size());
    if (!fill(index_, old_.frontiers.size(), -1)) return forget_frontiers();
    for (std::size_t k = 0; k < order.size(); ++k) index_[to_index(order[k])] = static_cast<int>(k);
    for (const int f : order) {
        if (out_of_time()) return forget_frontiers();
        now_.frontiers.push_back(old_.frontiers[to_index(f)]);
        now_.last.push_back(old_.last[to_index(f)]);
        now_.forward.push_back(old_.forward[to_index(f)]);
        now_.onward.push_back(old_.onward[to_index(f)]);
        now_.begin.push_back(now_.steps.size());
        for (std::size_t p = old_.begin[to_index(f)]; p < old_.end[to_index(f)]; ++p) {
            const Step& step = old_.steps[p];
            if (keep_step_[p] == 0 || step.to < 0 || index_[to_index(step.to)] < 0) continue;
            now_.steps.push_back({index_[to_index(step.to)], step.arc, step.turn});
        }
        now_.end.push_back(now_.steps.size());
    }
    std::size_t kept = 0;
    for (const int f : starts_) {
        if (index_[to_index(f)] >= 0) starts_[kept++] = index_[to_index(f)];
    }
    starts_.resize(kept);
}

double FrontierGraph::find_onward(double limit) {
    if (!fill(now_.onward, now_.frontiers.size(), kUnreachable)) {
        forget_frontiers();
        return -kUnreachable;
    }
    changed_.assign(now_.frontiers.size(), 0);
    bool again = true;
    for (int sweep = 1; again; ++sweep) {
        again = false;
        for (int f = size(); f-- > 0;) {
            if (out_of_time()) return -kUnreachable;
            const std::span<const Step> on = steps(f);
            const auto changed = [&](const Step& step) { return changed_[to_index(step.to)] >= sweep - 1; };
            if (sweep > 1 && std::none_of(on.begin(), on.end(), changed)) continue;
            double value = is_last(f) ? 0.0 : kUnreachable;
            for (const Step& step : on) value = std::min(value, cost(step) + onward(step.to));
            if (!is_cheaper(value, onward(f)) || !(value + now_.forward[to_index(f)] < limit)) continue;
            now_.onward[to_index(f)] = value;
            changed_[to_index(f)] = sweep;
            again = true;
        }
    }
    double bound = kUnreachable;
    for (const int f : starts_) bound = std::min(bound, start_cost(f) + now_.onward[to_index(f)]);
    return bound;
}

void FrontierGraph::find_forward() {
    if (!fill(now_.forward, now_.frontiers.size(), kUnreachable)) return forget_frontiers();
    changed_.assign(now_.frontiers.size(), 0);
    for (const int f : starts_) now_.forward[to_index(f)] = start_cost(f);
    bool again = true;
    for (int sweep = 1; again; ++sweep) {
        again = false;
        for (int f = 0; f < size(); ++f) {
            if (out_of_time()) return;
            const double value = now_.forward[to_index(f)];
            if (value == kUnreachable || (sweep > 1 && changed_[to_index(f)] < sweep - 1)) continue;
            for (const Step& step : steps(f)) {
                const double label = value + cost(step);
                if (!is_cheaper(label, now_.forward[to_index(step.to)])) continue;
                now_.forward[to_index(step.to)] = label;
                changed_[to_index(step.to)] = sweep;
                again |= step.to <= f;
            }
        }
    }
}

void FrontierGraph::drop(double limit) {
    order_.clear();
    if (!fill(keep_step_, now_.steps.size(), char{0})) return forget_frontiers();
    for (int f = 0; f < size(); ++f) {
        if (out_of_time()) return forget_frontiers();
        const double forward = now_.forward[to_index(f)];
        if (!(forward + onward(f) < limit)) continue;
        order_.push_back(f);
        for (std::size_t p = now_.begin[to_index(f)]; p < now_.end[to_index(f)]; ++p) {
            const Step& step = now_.steps[p];
            if (forward + cost(step) + onward(step.to) < limit) keep_step_[p] = 1;
        }
    }
    keep(order_);
}

void FrontierGraph::drop_dominated_edges(const EdgeSets& edges) {
    if (!fill(keep_step_, now_.steps.size(), char{1})) return;
    nothing_.assign(edges.words(), 0);
    if (!drop_steps_by_dominated<Walks::up_to>(edges)) return;
    if (!drop_steps_by_dominated<Walks::on_from>(edges)) return;
    order_.clear();
    for (int f = 0; f < size(); ++f) {
        if (out_of_time()) return;
        order_.push_back(f);
    }
    keep(order_);
}

template <FrontierGraph::Walks kWalks>
bool FrontierGraph::drop_steps_by_dominated(const EdgeSets& edges) {
    constexpr bool kUpTo = kWalks == Walks::up_to;
    const std::size_t words = edges.words();
    const auto row = [&](int f) { return dominated_.row(to_index(f)); };
    const auto source = [](int f, const Step& step) { return kUpTo ? f : step.to; };
    const auto target = [](int f, const Step& step) { return kUpTo ? step.to : f; };
    const auto is_dominated = [&](int f, const Step& step) {
        return step.arc >= 0 && EdgeSets::contains(row(source(f, step)), edges.number(step.arc));
    };
    const std::uint64_t* const nothing = nothing_.data();
    const auto own = [&](const Step& step) {
        if (step.arc < 0) return nothing;
        return kUpTo ? edges.lost_after(step.arc) : edges.lost_before(step.arc);
    };

    if (!fill_dominated(words)) return false;
    if constexpr (kUpTo) {
        for (const int f : starts_) {
            const Frontier& start = frontier(f);
            intersect_with_union(row(f), edges.lost_after(start.moving), edges.lost_after(start.waiting),
                                 words);
        }
    } else {
        for (int f = 0; f < size(); ++f) {
            if (is_last(f)) std::fill_n(row(f), words, std::uint64_t{0});
        }
    }
    changed_.assign(now_.frontiers.size(), 0);
    // What is taken out of a set lets more steps count, so sweeps go on until nothing changes.
    bool again = true;
    for (int sweep = 1; again; ++sweep) {
        again = false;
        for (int i = 0; i < size(); ++i) {
            if (out_of_time()) return false;
            const int f = kUpTo ? i : size() - 1 - i;
            if (kUpTo && changed_[to_index(f)] < sweep - 1) continue;
            for (std::size_t p = now_.begin[to_index(f)]; p < now_.end[to_index(f)]; ++p) {
                const Step& step = now_.steps[p];
                if (keep_step_[p] == 0 || changed_[to_index(source(f, step))] < sweep - 1 ||
                    is_dominated(f, step) ||
                    !intersect_with_union(row(target(f, step)), row(source(f, step)), own(step), words)) {
                    continue;
                }
                changed_[to_index(target(f, step))] = sweep;
                again |= !kUpTo || step.to <= f;
            }
        }
    }
    for (int f = 0; f < size(); ++f) {
        if (out_of_time()) return false;
        for (std::size_t p = now_.begin[to_index(f)]; p < now_.end[to_index(f)]; ++p) {
            if (is_dominated(f, now_.steps[p])) keep_step_[p] = 0;
        }
    }
    return true;
}

}  // namespace conelane::path_pair
