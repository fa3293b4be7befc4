#include "solvers/path_pair/primal/pair_beam.hpp"

#include <tuple>

namespace conelane::path_pair {
namespace {

constexpr int kMaxLead = 2;  ///< arcs that a leg may be ahead
constexpr std::size_t kMaxFirstSteps = 50'000;
constexpr std::size_t kWorkPerStep = 50;
constexpr std::size_t kStepsPerClock = 64;

// The order of a heap whose top is the cheapest step.
constexpr auto kDearer = [](const auto& a, const auto& b) {
    return std::tie(a.cost, a.last, a.label) > std::tie(b.cost, b.last, b.label);
};

}  // namespace

/// All pairs of first arcs, or the cheapest ones where they are many.
void PairBeam::find_first_steps() {
    edge_words_ = (to_index(graph_.edge_count()) + 63) / 64;
    words_ = edge_words_ + (to_index(graph_.cone_count()) + 63) / 64;
    first_steps_.clear();
    for (int a = 0; a < graph_.arc_count(); ++a) {
        if (!starts(a)) continue;
        if (clock_.out_of_time(to_index(graph_.arc_count()))) break;
        for (int b = a + 1; b < graph_.arc_count(); ++b) {
            const bool meet = graph_.tail(a) == graph_.tail(b) || graph_.tail(a) == graph_.head(b) ||
                              graph_.head(a) == graph_.tail(b) || graph_.head(a) == graph_.head(b);
            if (!starts(b) || meet || graph_.incompatible(a / 2, b / 2)) continue;
            first_steps_.push_back({-1, 0, {a, b}, graph_.cost(a / 2) + graph_.cost(b / 2)});
        }
        if (first_steps_.size() < kMaxFirstSteps) continue;
        const std::size_t kept = kMaxFirstSteps / 2;
        std::nth_element(first_steps_.begin(), first_steps_.begin() + static_cast<std::ptrdiff_t>(kept),
                         first_steps_.end(),
                         [](const Step& one, const Step& other) { return kDearer(other, one); });
        first_steps_.resize(kept);
    }
    clock_.out_of_time(kWorkPerStep * first_steps_.size());
    std::ranges::make_heap(first_steps_, kDearer);
    first_steps_heaped_ = first_steps_.size();
}

void PairBeam::run(const Limits& limits, Incumbent& incumbent) {
    limits_ = limits;
    labels_.clear();
    lost_next_.clear();
    next_ = 0;
    int best = -1;
    double best_cost = incumbent.cutoff();
    take_cheapest_first_steps();
    while (labels_.size() > next_ && !clock_.expired()) {
        steps_.clear();
        ++place_level_;
        level_ = std::exchange(next_, labels_.size());
        std::swap(lost_, lost_next_);
        lost_next_.clear();
        for (std::size_t l = level_; l < next_; ++l) {
            const Label& label = labels_[l];
            if (label.cost < best_cost && is_lane(label)) {
                best = static_cast<int>(l);
                best_cost = label.cost;
            }
            const std::size_t steps = add_steps(static_cast<int>(l), lost(l - level_));
            if (clock_.out_of_time(kWorkPerStep * steps)) break;
        }
        take_cheapest_steps();
    }
    if (best >= 0) offer(best, incumbent);
}

std::size_t PairBeam::add_steps(int l, const std::uint64_t* lost) {
    const Label& label = labels_[to_index(l)];
    std::size_t steps = 0;
    for (int leg = 0; leg < 2; ++leg) {
        if (label.length[to_index(leg)] >= label.length[to_index(1 - leg)] + kMaxLead) continue;
        for (const ArcGraph::Succession& next : graph_.successions(label.last[to_index(leg)])) {
            if (!allows(lost, next.arc)) continue;
            Step step{l, leg, label.last, label.cost + next.cost + graph_.cost(next.arc / 2)};
            step.last[to_index(leg)] = next.arc;
            add_step(step);
            ++steps;
        }
    }
    return steps;
}

std::size_t PairBeam::place_of(const std::array<int, 2>& last) const {
    constexpr std::uint64_t kSpread = 0x9e3779b97f4a7c15;
    const std::uint64_t key = to_index(last[0]) * to_index(graph_.arc_count()) + to_index(last[1]);
    std::size_t place = (key * kSpread >> 32U) & (places_.size() - 1);
    while (places_[place].level == place_level_ && steps_[places_[place].step].last != last)
        place = (place + 1) & (places_.size() - 1);
    return place;
}

void PairBeam::grow_places() {
    places_.assign(std::max<std::size_t>(1024, 2 * places_.size()), {0, 0});
    for (std::size_t step = 0; step < steps_.size(); ++step)
        places_[place_of(steps_[step].last)] = {place_level_, step};
}

void PairBeam::add_step(const Step& step) {
    if (2 * (steps_.size() + 1) > places_.size()) grow_places();
    Place& place = places_[place_of(step.last)];
    if (place.level != place_level_) {
        place = {place_level_, steps_.size()};
        steps_.push_back(step);
    } else if (kDearer(steps_[place.step], step)) {
        steps_[place.step] = step;
    }
}

void PairBeam::take_cheapest_first_steps() {
    at_cone_.assign(to_index(graph_.cone_count()), 0);
    for (std::size_t step = first_steps_.size(); step > 0 && !is_full(); --step) {
        if (step == first_steps_heaped_) {  // an earlier beam did not get so far
            if (step % kStepsPerClock == 0 && clock_.out_of_time()) return;
            std::pop_heap(first_steps_.begin(), first_steps_.begin() + static_cast<std::ptrdiff_t>(step),
                          kDearer);
            --first_steps_heaped_;
        }
        take(first_steps_[step - 1]);
    }
}

void PairBeam::take_cheapest_steps() {
    at_cone_.assign(to_index(graph_.cone_count()), 0);
    // A heap, because not all steps are looked at.
    std::ranges::make_heap(steps_, kDearer);
    for (auto end = steps_.end(); end != steps_.begin() && !is_full();) {
        const auto left = static_cast<std::size_t>(end - steps_.begin());
        if (left % kStepsPerClock == 0 && clock_.out_of_time()) return;
        std::pop_heap(steps_.begin(), end, kDearer);
        take(*--end);
    }
}

void PairBeam::take(const Step& step) {
    int& at_first = at_cone_[to_index(graph_.head(step.last[0]))];
    int& at_second = at_cone_[to_index(graph_.head(step.last[1]))];
    if (at_first + at_second >= limits_.max_at_cone) return;
    ++at_first;
    ++at_second;
    add_label(step);
}

void PairBeam::add_label(const Step& step) {
    Label label{
        .before = step.label, .last = step.last, .length = {1, 1}, .along_heading = 0, .cost = step.cost};
    lost_next_.resize(lost_next_.size() + words_, 0);
    std::uint64_t* const row = lost_next_.data() + (lost_next_.size() - words_);
    const auto take_arc = [&](int arc) {
        take_edge(arc, row);
        take_cone(graph_.head(arc), row);
        if (graph_.along_heading(arc / 2)) label.along_heading = std::min(2, label.along_heading + 1);
    };
    if (step.label < 0) {
        for (const int arc : step.last) {
            take_cone(graph_.tail(arc), row);
            take_arc(arc);
        }
    } else {
        const Label& before = labels_[to_index(step.label)];
        std::copy_n(lost(to_index(step.label) - level_), words_, row);
        label.length = before.length;
        label.along_heading = before.along_heading;
        ++label.length[to_index(step.leg)];
        take_arc(step.last[to_index(step.leg)]);
    }
    labels_.push_back(label);
}

bool PairBeam::is_lane(const Label& label) const {
    const std::array<int, 2> ends{graph_.head(label.last[0]), graph_.head(label.last[1])};
    return label.along_heading >= 2 && system_.kinds[0].end[to_index(ends[0])] != 0 &&
           system_.kinds[0].end[to_index(ends[1])] != 0 && graph_.are_partners(ends[0], ends[1]);
}

bool PairBeam::allows(const std::uint64_t* lost, int arc) const {
    const std::size_t edge = to_index(arc / 2);
    const std::size_t cone = to_index(graph_.head(arc));
    return (lost[edge / 64] >> (edge % 64) & 1) == 0 &&
           (lost[edge_words_ + cone / 64] >> (cone % 64) & 1) == 0;
}

void PairBeam::take_edge(int arc, std::uint64_t* lost) const {
    const std::span<const std::uint64_t> row = graph_.incompatible_row(arc / 2);
    for (std::size_t w = 0; w < row.size(); ++w) lost[w] |= row[w];
}

void PairBeam::take_cone(int cone, std::uint64_t* lost) const {
    lost[edge_words_ + to_index(cone) / 64] |= std::uint64_t{1} << (to_index(cone) % 64);
}

void PairBeam::offer(int label, Incumbent& incumbent) {
    for (std::vector<int>& leg : legs_) leg.clear();
    for (int l = label; l >= 0; l = labels_[to_index(l)].before) {
        for (std::size_t leg = 0; leg < 2; ++leg) {
            const int arc = labels_[to_index(l)].last[leg];
            if (legs_[leg].empty() || legs_[leg].back() != arc) legs_[leg].push_back(arc);
        }
    }
    for (std::vector<int>& leg : legs_) std::ranges::reverse(leg);
    incumbent.offer(legs_[0], legs_[1]);
}

}  // namespace conelane::path_pair
