#include "solvers/path_pair/primal/pair_beam.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace conelane::path_pair {
namespace {

constexpr int kMaxLead = 2;  ///< arcs that a leg may be ahead
constexpr std::size_t kMaxFirstSteps = 50'000;
constexpr std::size_t kWorkPerStep = 50;

}  // namespace

void PairBeam::run(const ArcGraph& graph, const LegSystem& system, const Limits& limits, Incumbent& incumbent,
                   SearchClock& clock) {
    graph_ = &graph;
    system_ = &system;
    limits_ = limits;
    edge_words_ = (to_index(graph.edge_count()) + 63) / 64;
    words_ = edge_words_ + (to_index(graph.cone_count()) + 63) / 64;
    labels_.clear();
    lost_next_.clear();
    next_ = 0;
    add_first_steps(clock);
    int best = -1;
    double best_cost = incumbent.cutoff();
    clock.out_of_time(kWorkPerStep * steps_.size());
    while (!steps_.empty() && !clock.struck()) {
        take_cheapest_steps(clock);
        steps_.clear();
        level_ = std::exchange(next_, labels_.size());
        std::swap(lost_, lost_next_);
        lost_next_.clear();
        for (std::size_t l = level_; l < next_; ++l) {
            const Label& label = labels_[l];
            if (label.cost < best_cost && is_lane(label)) {
                best = static_cast<int>(l);
                best_cost = label.cost;
            }
            const std::size_t steps = steps_.size();
            add_steps(static_cast<int>(l), lost(l - level_));
            if (clock.out_of_time(kWorkPerStep * (steps_.size() - steps))) break;
        }
    }
    if (best >= 0) offer(best, incumbent);
}

/// All pairs of first arcs, or the cheapest ones where they are many.
void PairBeam::add_first_steps(SearchClock& clock) {
    const auto cheaper = [](const Step& a, const Step& b) {
        return std::tie(a.cost, a.last) < std::tie(b.cost, b.last);
    };
    steps_.clear();
    for (int a = 0; a < graph_->arc_count(); ++a) {
        if (!starts(a)) continue;
        if (clock.out_of_time(to_index(graph_->arc_count()))) return;
        for (int b = a + 1; b < graph_->arc_count(); ++b) {
            const bool meet = graph_->tail(a) == graph_->tail(b) || graph_->tail(a) == graph_->head(b) ||
                              graph_->head(a) == graph_->tail(b) || graph_->head(a) == graph_->head(b);
            if (!starts(b) || meet || graph_->incompatible(a / 2, b / 2)) continue;
            steps_.push_back({-1, 0, {a, b}, graph_->cost(a / 2) + graph_->cost(b / 2)});
        }
        if (steps_.size() < kMaxFirstSteps) continue;
        const std::size_t kept = kMaxFirstSteps / 2;
        std::nth_element(steps_.begin(), steps_.begin() + static_cast<std::ptrdiff_t>(kept), steps_.end(),
                         cheaper);
        steps_.resize(kept);
    }
}

void PairBeam::add_steps(int l, const std::uint64_t* lost) {
    const Label& label = labels_[to_index(l)];
    for (int leg = 0; leg < 2; ++leg) {
        if (label.length[to_index(leg)] >= label.length[to_index(1 - leg)] + kMaxLead) continue;
        for (const ArcGraph::Succession& next : graph_->successions(label.last[to_index(leg)])) {
            if (!allows(lost, next.arc)) continue;
            Step step{l, leg, label.last, label.cost + next.cost + graph_->cost(next.arc / 2)};
            step.last[to_index(leg)] = next.arc;
            steps_.push_back(step);
        }
    }
}

void PairBeam::take_cheapest_steps(SearchClock& clock) {
    constexpr std::size_t kStepsPerClock = 64;
    // A heap, as few of many steps are taken: the cheapest one is in frontier.
    const auto dearer = [](const Step& a, const Step& b) {
        return std::tie(a.cost, a.last, a.label) > std::tie(b.cost, b.last, b.label);
    };
    std::make_heap(steps_.begin(), steps_.end(), dearer);
    at_cone_.assign(to_index(graph_->cone_count()), 0);
    for (auto end = steps_.end(); end != steps_.begin() && labels_.size() - next_ < limits_.width;) {
        const auto left = static_cast<std::size_t>(end - steps_.begin());
        if (left % kStepsPerClock == 0 && clock.out_of_time()) return;
        std::pop_heap(steps_.begin(), end, dearer);
        const Step& step = *--end;
        int& at_first = at_cone_[to_index(graph_->head(step.last[0]))];
        int& at_second = at_cone_[to_index(graph_->head(step.last[1]))];
        if (at_first + at_second >= limits_.max_at_cone) continue;
        const bool seen = std::any_of(labels_.begin() + static_cast<std::ptrdiff_t>(next_), labels_.end(),
                                      [&](const Label& label) { return label.last == step.last; });
        if (seen) continue;
        ++at_first;
        ++at_second;
        add_label(step);
    }
}

void PairBeam::add_label(const Step& step) {
    Label label{step.label, step.last, {1, 1}, 0, step.cost};
    lost_next_.resize(lost_next_.size() + words_, 0);
    std::uint64_t* const row = lost_next_.data() + (lost_next_.size() - words_);
    const auto take = [&](int arc) {
        take_edge(arc, row);
        take_cone(graph_->head(arc), row);
        if (graph_->along_heading(arc / 2)) label.along_heading = std::min(2, label.along_heading + 1);
    };
    if (step.label < 0) {
        for (const int arc : step.last) {
            take_cone(graph_->tail(arc), row);
            take(arc);
        }
    } else {
        const Label& before = labels_[to_index(step.label)];
        std::copy_n(lost(to_index(step.label) - level_), words_, row);
        label.length = before.length;
        label.along_heading = before.along_heading;
        ++label.length[to_index(step.leg)];
        take(step.last[to_index(step.leg)]);
    }
    labels_.push_back(label);
}

bool PairBeam::is_lane(const Label& label) const {
    const std::array<int, 2> ends{graph_->head(label.last[0]), graph_->head(label.last[1])};
    return label.along_heading >= 2 && system_->kinds[0].end[to_index(ends[0])] != 0 &&
           system_->kinds[0].end[to_index(ends[1])] != 0 && graph_->are_partners(ends[0], ends[1]);
}

bool PairBeam::allows(const std::uint64_t* lost, int arc) const {
    const std::size_t edge = to_index(arc / 2);
    const std::size_t cone = to_index(graph_->head(arc));
    return (lost[edge / 64] >> (edge % 64) & 1) == 0 &&
           (lost[edge_words_ + cone / 64] >> (cone % 64) & 1) == 0;
}

void PairBeam::take_edge(int arc, std::uint64_t* lost) const {
    const std::span<const std::uint64_t> row = graph_->incompatible_row(arc / 2);
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
