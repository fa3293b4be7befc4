#include "evaluation/checking/pair_enumeration.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

namespace conelane {
namespace {

constexpr std::size_t kNoArc = std::numeric_limits<std::size_t>::max();

/// mine = mine or theirs.
void add(std::vector<std::uint64_t>& mine, const std::vector<std::uint64_t>& theirs) {
    for (std::size_t w = 0; w < mine.size(); ++w) mine[w] |= theirs[w];
}

}  // namespace

PairEnumeration::PairEnumeration(const ExactScene& scene, const LegKinds& kinds, const WalkGraph& graph,
                                 const WalkBounds& bounds, const Exact& limit)
    : scene_(scene),
      kinds_(kinds),
      graph_(graph),
      bounds_(bounds),
      limit_(limit),
      most_(limit + bounds.offset()) {
    for (std::size_t kind = 0; kind < kinds.count(); ++kind) leg_onward_.push_back(bounds.onward(kind));
    find_taken();
}

PairEnumeration::Outcome PairEnumeration::run(std::int64_t& steps_left) {
    if (!find_fronts(steps_left)) return Outcome::too_many_steps;
    find_steps();
    find_onward();
    drop_fronts();
    drop_taken_by_all();
    find_forward();
    find_onward();
    drop_fronts();
    find_wanted();
    return enumerate(steps_left);
}

/// What an arc excludes for all that comes after it, in either leg: its edge, those that exclude it, its
/// cones.
void PairEnumeration::find_taken() {
    const std::size_t edges = scene_.edges.size();
    words_ = (edges + scene_.end_cost.size() + 63) / 64;
    for (const std::size_t arc : graph_.arc) {
        Set& taken = taken_by_.emplace_back(words_, 0);
        const auto insert = [&](std::size_t bit) { taken[bit / 64] |= std::uint64_t{1} << (bit % 64); };
        insert(arc / 2);
        insert(edges + scene_.tail(arc));
        insert(edges + scene_.head(arc));
        const boost::dynamic_bitset<>& excluded = scene_.excluded[arc / 2];
        for (auto e = excluded.find_first(); e != boost::dynamic_bitset<>::npos; e = excluded.find_next(e))
            insert(e);
    }
}

std::vector<PairEnumeration::Front> PairEnumeration::first_fronts() const {
    const std::size_t second = kinds_.other(0);
    std::vector<Front> fronts;
    for (std::size_t a = 0; a < graph_.arc.size(); ++a) {
        if (!bounds_.start(0, a)) continue;
        for (std::size_t b = kinds_.count() == 1 ? a + 1 : 0; b < graph_.arc.size(); ++b) {
            const std::size_t tail = scene_.tail(graph_.arc[b]);
            if (a == b || !bounds_.start(second, b) || !fits(taken_by_[a], b) ||
                contains(taken_by_[a], scene_.edges.size() + tail)) {
                continue;
            }
            fronts.push_back(a < b ? Front{a, b, 0, false} : Front{b, a, second, false});
        }
    }
    return fronts;
}

Exact PairEnumeration::start_cost(const Front& front) const {
    return *bounds_.start(front.kind, front.moving) + *bounds_.start(kinds_.other(front.kind), front.waiting);
}

/// Whether the front ends both legs by one more step of no cost but the moving leg's end.
bool PairEnumeration::is_last(const Front& front) const {
    if (!front.ended || !bounds_.end(front.kind, front.moving)) return false;
    const std::size_t one = scene_.head(graph_.arc[front.moving]);
    const std::size_t other = scene_.head(graph_.arc[front.waiting]);
    return one != other && (kinds_.partners == nullptr || (*kinds_.partners)[one][other]);
}

/// Calls `visit(next front, arc, cost, reduced cost)`.
template <typename Visit>
void PairEnumeration::for_each_step(const Front& front, const Visit& visit) const {
    const std::size_t other = kinds_.other(front.kind);
    for (const WalkGraph::Turn& turn : graph_.turns[front.moving]) {
        if (!fits(taken_by_[front.waiting], turn.to)) continue;
        const Exact cost = turn.cost + scene_.edge_cost[edge_bit(turn.to)];
        const Exact reduced = turn.cost + bounds_.reduced(turn.to);
        const bool goes_on = front.ended || turn.to < front.waiting;
        visit(goes_on ? Front{turn.to, front.waiting, front.kind, front.ended}
                      : Front{front.waiting, turn.to, other, false},
              turn.to, cost, reduced);
    }
    const WalkCost end = front.ended ? std::nullopt : bounds_.end(front.kind, front.moving);
    if (end) visit(Front{front.waiting, front.moving, other, true}, kNoArc, *end, *end);
}

/// By the cheapest ways on of single legs.
bool PairEnumeration::may_be_below(const Front& front, const Exact& reduced) const {
    WalkCost cost = sum(WalkCost(reduced), leg_onward_[front.kind][front.moving]);
    if (!front.ended) cost = sum(cost, leg_onward_[kinds_.other(front.kind)][front.waiting]);
    return cost && *cost < most_;
}

/// Fronts that a pair below the limit may pass, each with its cheapest walk. False where they are too many.
bool PairEnumeration::find_fronts(std::int64_t& steps_left) {
    std::map<Front, Exact> forward;
    std::set<Front> open;
    const auto offer = [&](const Front& front, const Exact& reduced) {
        if (!may_be_below(front, reduced)) return;
        const auto [known, is_new] = forward.try_emplace(front, reduced);
        if (!is_new && known->second <= reduced) return;
        known->second = reduced;
        open.insert(front);
    };
    for (const Front& front : first_fronts()) offer(front, start_cost(front));
    while (!open.empty()) {
        const Front front = *open.begin();
        open.erase(open.begin());
        if (--steps_left < 0) return false;
        const Exact cost = forward.at(front);
        for_each_step(front, [&](const Front& next, std::size_t, const Exact&, const Exact& reduced) {
            offer(next, cost + reduced);
        });
    }
    for (const auto& [front, cost] : forward) {
        fronts_.push_back(front);
        forward_.emplace_back(cost);
    }
    return true;
}

void PairEnumeration::find_steps() {
    steps_.assign(fronts_.size(), {});
    for (std::size_t f = 0; f < fronts_.size(); ++f) {
        for_each_step(
            fronts_[f], [&](const Front& next, std::size_t arc, const Exact& cost, const Exact& reduced) {
                const auto to = std::ranges::lower_bound(fronts_, next);
                if (to == fronts_.end() || *to != next || !may_be_below(next, *forward_[f] + reduced)) return;
                steps_[f].push_back({static_cast<std::size_t>(to - fronts_.begin()), arc, cost, reduced});
            });
    }
}

void PairEnumeration::find_onward() {
    onward_.assign(fronts_.size(), std::nullopt);
    for (std::size_t f = 0; f < fronts_.size(); ++f) {
        if (is_last(fronts_[f])) onward_[f] = bounds_.end(fronts_[f].kind, fronts_[f].moving);
    }
    for (bool shorter = true; shorter;) {
        shorter = false;
        for (std::size_t f = fronts_.size(); f-- > 0;) {
            for (const Step& step : steps_[f]) {
                const WalkCost cost = sum(onward_[step.to], step.reduced);
                if (!cheaper(cost, onward_[f])) continue;
                onward_[f] = cost;
                shorter = true;
            }
        }
    }
}

void PairEnumeration::find_forward() {
    forward_.assign(fronts_.size(), std::nullopt);
    for (const Front& front : first_fronts()) {
        const auto at = std::ranges::lower_bound(fronts_, front);
        if (at == fronts_.end() || *at != front) continue;
        forward_[static_cast<std::size_t>(at - fronts_.begin())] = start_cost(front);
    }
    for (bool shorter = true; shorter;) {
        shorter = false;
        for (std::size_t f = 0; f < fronts_.size(); ++f) {
            for (const Step& step : steps_[f]) {
                const WalkCost cost = sum(forward_[f], step.reduced);
                if (!cheaper(cost, forward_[step.to])) continue;
                forward_[step.to] = cost;
                shorter = true;
            }
        }
    }
}

/// Drops fronts and steps that no walk below the limit passes.
void PairEnumeration::drop_fronts() {
    const auto is_below = [&](std::size_t from, const Exact& on, std::size_t to) {
        const WalkCost cost = sum(sum(forward_[from], on), onward_[to]);
        return cost && *cost < most_;
    };
    std::vector<std::size_t> place(fronts_.size(), kNoArc);
    std::size_t kept = 0;
    for (std::size_t f = 0; f < fronts_.size(); ++f) {
        if (is_below(f, 0, f)) place[f] = kept++;
    }
    for (std::size_t f = 0; f < fronts_.size(); ++f) {
        if (place[f] == kNoArc) continue;
        std::vector<Step> steps;
        for (const Step& step : steps_[f]) {
            if (place[step.to] == kNoArc || !is_below(f, step.reduced, step.to)) continue;
            steps.push_back({place[step.to], step.arc, step.cost, step.reduced});
        }
        steps_[place[f]] = std::move(steps);
    }
    for (std::size_t f = 0; f < fronts_.size(); ++f) {
        if (place[f] == kNoArc) continue;
        fronts_[place[f]] = fronts_[f];
        forward_[place[f]] = forward_[f];
        onward_[place[f]] = onward_[f];
    }
    fronts_.resize(kept);
    forward_.resize(kept);
    onward_.resize(kept);
    steps_.resize(kept);
}

/// Drops steps by an arc that every walk up to their front excludes.
void PairEnumeration::drop_taken_by_all() {
    std::vector<Set> by_all(fronts_.size(), Set(words_, ~std::uint64_t{0}));
    const auto narrow = [&](std::size_t f, const Set& set) {
        bool changed = false;
        for (std::size_t w = 0; w < words_; ++w) {
            const std::uint64_t both = by_all[f][w] & set[w];
            changed = changed || both != by_all[f][w];
            by_all[f][w] = both;
        }
        return changed;
    };
    for (const Front& front : first_fronts()) {
        const auto at = std::ranges::lower_bound(fronts_, front);
        if (at == fronts_.end() || *at != front) continue;
        Set taken = taken_by_[front.moving];
        add(taken, taken_by_[front.waiting]);
        narrow(static_cast<std::size_t>(at - fronts_.begin()), taken);
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t f = 0; f < fronts_.size(); ++f) {
            for (const Step& step : steps_[f]) {
                Set taken = by_all[f];
                if (step.arc != kNoArc) add(taken, taken_by_[step.arc]);
                changed = narrow(step.to, taken) || changed;
            }
        }
    }
    for (std::size_t f = 0; f < fronts_.size(); ++f) {
        std::erase_if(steps_[f],
                      [&](const Step& step) { return step.arc != kNoArc && !fits(by_all[f], step.arc); });
    }
}

void PairEnumeration::find_wanted() {
    wanted_.assign(fronts_.size(), Set(words_, 0));
    const auto insert = [](Set& set, std::size_t bit) { set[bit / 64] |= std::uint64_t{1} << (bit % 64); };
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t f = fronts_.size(); f-- > 0;) {
            Set wanted = wanted_[f];
            for (const Step& step : steps_[f]) {
                add(wanted, wanted_[step.to]);
                if (step.arc == kNoArc) continue;
                insert(wanted, edge_bit(step.arc));
                insert(wanted, head_bit(step.arc));
            }
            changed = changed || wanted != wanted_[f];
            wanted_[f] = std::move(wanted);
        }
    }
}

PairEnumeration::Label PairEnumeration::extended(const Label& label, const Step& step) const {
    Label on{label.cost + step.cost, label.reduced + step.reduced, label.along_heading, label.taken};
    if (step.arc == kNoArc) return on;
    add(on.taken, taken_by_[step.arc]);
    if (scene_.along_heading[edge_bit(step.arc)]) on.along_heading = std::min(2, on.along_heading + 1);
    return on;
}

PairEnumeration::Outcome PairEnumeration::enumerate(std::int64_t& steps_left) {
    waiting_.assign(fronts_.size(), {});
    for (const Front& front : first_fronts()) {
        const auto at = std::ranges::lower_bound(fronts_, front);
        if (at == fronts_.end() || *at != front) continue;
        Label label{0, start_cost(front), 0, Set(words_, 0)};
        for (const std::size_t arc : {front.moving, front.waiting}) {
            const Exact cost =
                scene_.end_cost[scene_.tail(graph_.arc[arc])] + scene_.edge_cost[edge_bit(arc)];
            label = extended(label, {0, arc, cost, 0});
        }
        const auto f = static_cast<std::size_t>(at - fronts_.begin());
        waiting_[f].push_back(std::move(label));
        open_.insert(f);
    }
    while (!open_.empty()) {
        const std::size_t f = *open_.begin();
        open_.erase(open_.begin());
        if (!settle(f, steps_left)) return Outcome::too_many_steps;
        if (found_one_) return Outcome::found_one;
    }
    return Outcome::none_below;
}

/// Goes on with the labels of a front that no other one dominates.
bool PairEnumeration::settle(std::size_t front, std::int64_t& steps_left) {
    std::vector<Label> labels = std::exchange(waiting_[front], {});
    std::ranges::stable_sort(labels, {}, &Label::cost);
    std::vector<const Label*> kept;
    for (const Label& label : labels) {
        const auto dominates = [&](const Label* other) {
            if (other->along_heading < label.along_heading) return false;
            for (std::size_t w = 0; w < words_; ++w) {
                if ((other->taken[w] & wanted_[front][w] & ~label.taken[w]) != 0) return false;
            }
            return true;
        };
        if (--steps_left < 0) return false;
        if (std::ranges::any_of(kept, dominates)) continue;
        kept.push_back(&label);
        expand(label, front);
    }
    return true;
}

void PairEnumeration::expand(const Label& label, std::size_t front) {
    if (is_last(fronts_[front]) && label.along_heading >= 2) {
        found_one_ =
            found_one_ || label.cost + *bounds_.end(fronts_[front].kind, fronts_[front].moving) < limit_;
    }
    for (const Step& step : steps_[front]) {
        if (!(*sum(onward_[step.to], Exact(label.reduced + step.reduced)) < most_)) continue;
        if (step.arc != kNoArc && !fits(label.taken, step.arc)) continue;
        waiting_[step.to].push_back(extended(label, step));
        open_.insert(step.to);
    }
}

}  // namespace conelane
