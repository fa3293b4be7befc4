#include "evaluation/proofs/pair_enumeration.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

namespace conelane {
namespace {

constexpr std::size_t kNoArc = std::numeric_limits<std::size_t>::max();

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
    if (!find_frontiers(steps_left)) return Outcome::too_many_steps;
    find_steps();
    find_onward();
    drop_frontiers();
    drop_taken_by_all();
    find_forward();
    find_onward();
    drop_frontiers();
    find_wanted();
    return enumerate(steps_left);
}

/// What an arc excludes for all later arcs of both legs: its edge, the edges incompatible with it, and its
/// cones.
void PairEnumeration::find_taken() {
    bits_ = scene_.edges.size() + scene_.end_cost.size();
    for (std::size_t place = 0; place < graph_.arc.size(); ++place) {
        Set& taken = taken_by_.emplace_back(scene_.excluded[edge_bit(place)]);
        taken.resize(bits_);
        taken.set(edge_bit(place)).set(tail_bit(place)).set(head_bit(place));
    }
}

std::vector<PairEnumeration::Frontier> PairEnumeration::first_frontiers() const {
    const std::size_t second = kinds_.other(0);
    std::vector<Frontier> frontiers;
    for (std::size_t a = 0; a < graph_.arc.size(); ++a) {
        if (!bounds_.start(0, a)) continue;
        for (std::size_t b = kinds_.count() == 1 ? a + 1 : 0; b < graph_.arc.size(); ++b) {
            if (a == b || !bounds_.start(second, b) || !fits(taken_by_[a], b) || taken_by_[a][tail_bit(b)])
                continue;
            frontiers.push_back(a < b ? Frontier{a, b, 0, false} : Frontier{b, a, second, false});
        }
    }
    return frontiers;
}

/// Places of the frontiers with which pairs begin.
std::vector<std::size_t> PairEnumeration::first_places() const {
    std::vector<std::size_t> places;
    for (const Frontier& frontier : first_frontiers()) {
        const auto at = std::ranges::lower_bound(frontiers_, frontier);
        if (at != frontiers_.end() && *at == frontier)
            places.push_back(static_cast<std::size_t>(at - frontiers_.begin()));
    }
    return places;
}

Exact PairEnumeration::start_cost(const Frontier& frontier) const {
    return *bounds_.start(frontier.kind, frontier.moving) +
           *bounds_.start(kinds_.other(frontier.kind), frontier.waiting);
}

/// Whether one more step ends both legs, at no cost but that of the moving leg's end.
bool PairEnumeration::is_last(const Frontier& frontier) const {
    if (!frontier.ended || !bounds_.end(frontier.kind, frontier.moving)) return false;
    const std::size_t one = scene_.head(graph_.arc[frontier.moving]);
    const std::size_t other = scene_.head(graph_.arc[frontier.waiting]);
    return one != other && (kinds_.partners == nullptr || (*kinds_.partners)[one][other]);
}

/// Calls `visit(next frontier, arc, cost, reduced cost)`.
template <typename Visit>
void PairEnumeration::for_each_step(const Frontier& frontier, const Visit& visit) const {
    const std::size_t other = kinds_.other(frontier.kind);
    for (const WalkGraph::Turn& turn : graph_.turns[frontier.moving]) {
        if (!fits(taken_by_[frontier.waiting], turn.to)) continue;
        const Exact cost = turn.cost + scene_.edge_cost[edge_bit(turn.to)];
        const Exact reduced = turn.cost + bounds_.reduced(turn.to);
        const bool goes_on = frontier.ended || turn.to < frontier.waiting;
        visit(goes_on ? Frontier{turn.to, frontier.waiting, frontier.kind, frontier.ended}
                      : Frontier{frontier.waiting, turn.to, other, false},
              turn.to, cost, reduced);
    }
    const WalkCost end = frontier.ended ? std::nullopt : bounds_.end(frontier.kind, frontier.moving);
    if (end) visit(Frontier{frontier.waiting, frontier.moving, other, true}, kNoArc, *end, *end);
}

/// A lower bound from the cheapest continuations of single legs.
bool PairEnumeration::may_be_below(const Frontier& frontier, const Exact& reduced) const {
    WalkCost cost = sum(WalkCost(reduced), leg_onward_[frontier.kind][frontier.moving]);
    if (!frontier.ended) cost = sum(cost, leg_onward_[kinds_.other(frontier.kind)][frontier.waiting]);
    return cost && *cost < most_;
}

/// Frontiers that a pair below the limit may pass, each with its cheapest walk. False if there are too
/// many.
bool PairEnumeration::find_frontiers(std::int64_t& steps_left) {
    std::map<Frontier, Exact> forward;
    std::set<Frontier> open;
    const auto offer = [&](const Frontier& frontier, const Exact& reduced) {
        if (!may_be_below(frontier, reduced)) return;
        const auto [known, is_new] = forward.try_emplace(frontier, reduced);
        if (!is_new && known->second <= reduced) return;
        known->second = reduced;
        open.insert(frontier);
    };
    for (const Frontier& frontier : first_frontiers()) offer(frontier, start_cost(frontier));
    while (!open.empty()) {
        const Frontier frontier = *open.begin();
        open.erase(open.begin());
        if (--steps_left < 0) return false;
        const Exact cost = forward.at(frontier);
        for_each_step(frontier, [&](const Frontier& next, std::size_t, const Exact&, const Exact& reduced) {
            offer(next, cost + reduced);
        });
    }
    for (const auto& [frontier, cost] : forward) {
        frontiers_.push_back(frontier);
        forward_.emplace_back(cost);
    }
    return true;
}

void PairEnumeration::find_steps() {
    steps_.assign(frontiers_.size(), {});
    for (std::size_t f = 0; f < frontiers_.size(); ++f) {
        for_each_step(frontiers_[f], [&](const Frontier& next, std::size_t arc, const Exact& cost,
                                         const Exact& reduced) {
            const auto to = std::ranges::lower_bound(frontiers_, next);
            if (to == frontiers_.end() || *to != next || !may_be_below(next, *forward_[f] + reduced)) return;
            steps_[f].push_back({static_cast<std::size_t>(to - frontiers_.begin()), arc, cost, reduced});
        });
    }
}

void PairEnumeration::find_onward() {
    onward_.assign(frontiers_.size(), std::nullopt);
    for (std::size_t f = 0; f < frontiers_.size(); ++f) {
        if (is_last(frontiers_[f])) onward_[f] = bounds_.end(frontiers_[f].kind, frontiers_[f].moving);
    }
    for (bool shorter = true; shorter;) {
        shorter = false;
        for (std::size_t f = frontiers_.size(); f-- > 0;) {
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
    forward_.assign(frontiers_.size(), std::nullopt);
    for (const std::size_t f : first_places()) forward_[f] = start_cost(frontiers_[f]);
    for (bool shorter = true; shorter;) {
        shorter = false;
        for (std::size_t f = 0; f < frontiers_.size(); ++f) {
            for (const Step& step : steps_[f]) {
                const WalkCost cost = sum(forward_[f], step.reduced);
                if (!cheaper(cost, forward_[step.to])) continue;
                forward_[step.to] = cost;
                shorter = true;
            }
        }
    }
}

/// Drops frontiers and steps that no walk below the limit passes.
void PairEnumeration::drop_frontiers() {
    const auto is_below = [&](std::size_t from, const Exact& on, std::size_t to) {
        const WalkCost cost = sum(sum(forward_[from], on), onward_[to]);
        return cost && *cost < most_;
    };
    std::vector<std::size_t> place(frontiers_.size(), kNoArc);
    std::size_t kept = 0;
    for (std::size_t f = 0; f < frontiers_.size(); ++f) {
        if (is_below(f, 0, f)) place[f] = kept++;
    }
    for (std::size_t f = 0; f < frontiers_.size(); ++f) {
        if (place[f] == kNoArc) continue;
        std::vector<Step> steps;
        for (const Step& step : steps_[f]) {
            if (place[step.to] == kNoArc || !is_below(f, step.reduced, step.to)) continue;
            steps.push_back({place[step.to], step.arc, step.cost, step.reduced});
        }
        steps_[place[f]] = std::move(steps);
    }
    for (std::size_t f = 0; f < frontiers_.size(); ++f) {
        if (place[f] == kNoArc) continue;
        frontiers_[place[f]] = frontiers_[f];
        forward_[place[f]] = forward_[f];
        onward_[place[f]] = onward_[f];
    }
    frontiers_.resize(kept);
    forward_.resize(kept);
    onward_.resize(kept);
    steps_.resize(kept);
}

/// Drops steps by an arc that every walk up to their frontier excludes.
void PairEnumeration::drop_taken_by_all() {
    std::vector<Set> by_all(frontiers_.size(), ~Set(bits_));
    const auto narrow = [&](std::size_t f, const Set& set) {
        const bool changed = !by_all[f].is_subset_of(set);
        by_all[f] &= set;
        return changed;
    };
    for (const std::size_t f : first_places())
        narrow(f, taken_by_[frontiers_[f].moving] | taken_by_[frontiers_[f].waiting]);
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t f = 0; f < frontiers_.size(); ++f) {
            for (const Step& step : steps_[f]) {
                Set taken = by_all[f];
                if (step.arc != kNoArc) taken |= taken_by_[step.arc];
                changed = narrow(step.to, taken) || changed;
            }
        }
    }
    for (std::size_t f = 0; f < frontiers_.size(); ++f) {
        std::erase_if(steps_[f],
                      [&](const Step& step) { return step.arc != kNoArc && !fits(by_all[f], step.arc); });
    }
}

void PairEnumeration::find_wanted() {
    wanted_.assign(frontiers_.size(), Set(bits_));
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t f = frontiers_.size(); f-- > 0;) {
            Set wanted = wanted_[f];
            for (const Step& step : steps_[f]) {
                wanted |= wanted_[step.to];
                if (step.arc != kNoArc) wanted.set(edge_bit(step.arc)).set(head_bit(step.arc));
            }
            changed = changed || wanted != wanted_[f];
            wanted_[f] = std::move(wanted);
        }
    }
}

PairEnumeration::Label PairEnumeration::extended(const Label& label, const Step& step) const {
    Label on{label.cost + step.cost, label.reduced + step.reduced, label.along_heading, label.taken};
    if (step.arc == kNoArc) return on;
    on.taken |= taken_by_[step.arc];
    if (scene_.along_heading[edge_bit(step.arc)]) on.along_heading = std::min(2, on.along_heading + 1);
    return on;
}

PairEnumeration::Outcome PairEnumeration::enumerate(std::int64_t& steps_left) {
    waiting_.assign(frontiers_.size(), {});
    for (const std::size_t f : first_places()) {
        const Frontier& frontier = frontiers_[f];
        Label label{0, start_cost(frontier), 0, Set(bits_)};
        for (const std::size_t arc : {frontier.moving, frontier.waiting}) {
            const Exact cost =
                scene_.end_cost[scene_.tail(graph_.arc[arc])] + scene_.edge_cost[edge_bit(arc)];
            label = extended(label, {0, arc, cost, 0});
        }
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

/// Extends the labels of a frontier that no other label dominates.
bool PairEnumeration::settle(std::size_t frontier, std::int64_t& steps_left) {
    std::vector<Label> labels = std::exchange(waiting_[frontier], {});
    std::ranges::stable_sort(labels, {}, &Label::cost);
    std::vector<const Label*> kept;
    for (const Label& label : labels) {
        const Set open = wanted_[frontier] - label.taken;
        const auto dominates = [&](const Label* other) {
            return other->along_heading >= label.along_heading && !other->taken.intersects(open);
        };
        if (--steps_left < 0) return false;
        if (std::ranges::any_of(kept, dominates)) continue;
        kept.push_back(&label);
        expand(label, frontier);
    }
    return true;
}

void PairEnumeration::expand(const Label& label, std::size_t frontier) {
    if (is_last(frontiers_[frontier]) && label.along_heading >= 2) {
        found_one_ =
            found_one_ ||
            label.cost + *bounds_.end(frontiers_[frontier].kind, frontiers_[frontier].moving) < limit_;
    }
    for (const Step& step : steps_[frontier]) {
        if (!(*sum(onward_[step.to], Exact(label.reduced + step.reduced)) < most_)) continue;
        if (step.arc != kNoArc && !fits(label.taken, step.arc)) continue;
        waiting_[step.to].push_back(extended(label, step));
        open_.insert(step.to);
    }
}

}  // namespace conelane
