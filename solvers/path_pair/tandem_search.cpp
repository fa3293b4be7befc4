#include "solvers/path_pair/tandem_search.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace conelane::path_pair {
namespace {

constexpr std::size_t kLevels = 16;  ///< of slack
constexpr std::size_t kFewSlots = std::size_t{1} << 8;
constexpr std::size_t kManySlots = std::size_t{1} << 17;
constexpr int kMostRivals = 30;          ///< looked at per label, newest first
constexpr std::size_t kFewLabels = 500;  ///< up to here detours and many slots are not worth their making
constexpr int kMostDetourArcs = 2000;    ///< their table grows with the square
constexpr std::int64_t kLabelsPerClock = 128;
constexpr int kSourcesPerClock = 32;
// What rounding may make of a detour.
constexpr double kDetourRounding = 1e-6;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

void insert(std::vector<std::uint64_t>& sets, std::size_t row, std::size_t words, std::size_t member) {
    sets[row * words + member / 64] |= std::uint64_t{1} << (member % 64);
}

}  // namespace

void TandemSearch::bind(const ArcGraph& graph, PairRelaxation& relaxation, Incumbent& incumbent) {
    graph_ = &graph;
    relaxation_ = &relaxation;
    incumbent_ = &incumbent;
}

double TandemSearch::limit(double tolerance) const {
    return incumbent_->cutoff() - tolerance + relaxation_->offset();
}

bool TandemSearch::abreast(int a, int b) const {
    const ResidualGraph& r = *residual_;
    return r.head[at(a)] != r.head[at(b)] && r.head[at(a)] != r.tail[at(b)] &&
           r.tail[at(a)] != r.head[at(b)] && r.tail[at(a)] != r.tail[at(b)] &&
           !graph_->incompatible(r.edge(a), r.edge(b));
}

void TandemSearch::number_edges() {
    number_.assign(at(graph_->edge_count()), -1);
    edges_.clear();
    for (int a = 0; a < residual_->size(); ++a) {
        int& number = number_[at(residual_->edge(a))];
        if (number >= 0) continue;
        number = static_cast<int>(edges_.size());
        edges_.push_back(residual_->edge(a));
    }
    words_ = (edges_.size() + 63) / 64;
    excluded_.assign(edges_.size() * words_, 0);
    at_cone_.assign(at(graph_->cone_count()) * words_, 0);
    for (std::size_t k = 0; k < edges_.size(); ++k) {
        const int edge = edges_[k];
        const std::span<const std::uint64_t> row = graph_->incompatible_row(edge);
        for (std::size_t w = 0; w < row.size(); ++w) {
            for (std::uint64_t bits = row[w]; bits != 0; bits &= bits - 1) {
                const int other = number_[w * 64 + static_cast<std::size_t>(std::countr_zero(bits))];
                if (other >= 0) insert(excluded_, k, words_, at(other));
            }
        }
        insert(at_cone_, at(graph_->tail(2 * edge)), words_, k);
        insert(at_cone_, at(graph_->head(2 * edge)), words_, k);
    }
}

/// The detour over b from a is what the cheapest way on from a costs more where it has to use b. An edge is
/// on a way on below the cutoff only if its detour is less than the label's slack.
bool TandemSearch::find_detours(const std::function<bool()>& stopped) {
    const ResidualGraph& r = *residual_;
    const auto kinds = at(relaxation_->system().kind_count);
    within_.assign(kinds * r.arc.size() * kLevels * words_, 0);
    detour_.assign(r.arc.size(), kUnreachable);
    const std::span<const double> reduced = relaxation_->reduced();
    for (std::size_t kind = 0; kind < kinds; ++kind) {
        const std::vector<double>& onward = onward_[kind];
        for (int source = 0; source < r.size(); ++source) {
            if (onward[at(source)] == kUnreachable) continue;
            if (source % kSourcesPerClock == 0 && stopped()) return false;
            queue_.assign(1, source);
            detour_[at(source)] = 0.0;
            for (std::size_t done = 0; done < queue_.size(); ++done) {
                const int a = queue_[done];
                for (int p = r.out_start[at(a)]; p < r.out_start[at(a) + 1]; ++p) {
                    const int b = r.out_arc[at(p)];
                    const double detour =
                        detour_[at(a)] + r.out_cost[at(p)] + reduced[at(b)] + onward[at(b)] - onward[at(a)];
                    if (!(detour < gap_ + kDetourRounding) || !(detour < detour_[at(b)] - 1e-9)) continue;
                    detour_[at(b)] = detour;
                    queue_.push_back(b);
                }
            }
            const std::size_t row = (kind * r.arc.size() + at(source)) * kLevels;
            for (const int b : queue_) {
                const double detour = std::exchange(detour_[at(b)], kUnreachable);
                if (detour == kUnreachable || b == source) continue;
                const double share = std::max(0.0, detour - kDetourRounding) / gap_;
                const auto level = static_cast<std::size_t>(share * static_cast<double>(kLevels));
                if (level < kLevels) insert(within_, row + level, words_, at(number_[at(r.edge(b))]));
            }
            for (std::size_t w = row * words_ + words_; w < (row + kLevels) * words_; ++w) {
                within_[w] |= within_[w - words_];
            }
        }
    }
    has_detours_ = true;
    return true;
}

std::uint64_t TandemSearch::key(const Front& front) const {
    return (static_cast<std::uint64_t>(front.moving) << 32) +
           (static_cast<std::uint64_t>(front.waiting) << 2) + (front.moving_kind == 1 ? 2U : 0U) +
           (front.ended ? 1U : 0U);
}

int& TandemSearch::newest(std::uint64_t key) {
    // Fibonacci hashing: the upper half depends on all bits.
    return newest_[static_cast<std::size_t>(key * 0x9E3779B97F4A7C15U >> 32) & (newest_.size() - 1)];
}

void TandemSearch::use_slots(std::size_t count) {
    newest_.assign(count, -1);
    for (std::size_t l = 0; l < labels_.size(); ++l) {
        labels_[l].older = std::exchange(newest(labels_[l].key), static_cast<int>(l));
    }
}

bool TandemSearch::dominated(double slack) {
    const std::uint64_t* moving_ways = nullptr;
    const std::uint64_t* waiting_ways = nullptr;
    if (has_detours_) {
        const auto row = [&](int kind, int arc) {
            const std::size_t level =
                std::min(kLevels - 1, static_cast<std::size_t>(slack / gap_ * static_cast<double>(kLevels)));
            return within_.data() + ((at(kind) * residual_->arc.size() + at(arc)) * kLevels + level) * words_;
        };
        moving_ways = row(label_.front.moving_kind, label_.front.moving);
        waiting_ways = row(relaxation_->other(label_.front.moving_kind), label_.front.waiting);
    }
    int looked_at = 0;
    for (int other = newest(label_.key); other >= 0 && looked_at < kMostRivals;
         other = labels_[at(other)].older) {
        const Label& rival = labels_[at(other)];
        if (rival.key != label_.key) continue;
        ++looked_at;
        if (rival.cost > label_.cost || rival.along_heading < label_.along_heading) continue;
        const std::uint64_t* const rival_lost = lost_.data() + at(other) * words_;
        bool covers = true;
        for (std::size_t w = 0; w < words_ && covers; ++w) {
            std::uint64_t only_rival = rival_lost[w] & ~label_lost_[w];
            if (has_detours_) only_rival &= moving_ways[w] | (label_.front.ended ? 0 : waiting_ways[w]);
            covers = only_rival == 0;
        }
        if (covers) return true;
    }
    return false;
}

void TandemSearch::take_arc(int arc) {
    const int edge = residual_->edge(arc);
    const std::uint64_t* const excluded = excluded_.data() + at(number_[at(edge)]) * words_;
    const std::uint64_t* const left = at_cone_.data() + at(residual_->tail[at(arc)]) * words_;
    for (std::size_t w = 0; w < words_; ++w) label_lost_[w] |= excluded[w] | left[w];
    label_.cost += graph_->cost(edge);
    if (graph_->along_heading(edge)) label_.along_heading = std::min(2, label_.along_heading + 1);
}

void TandemSearch::take(const Step& step) {
    label_ = {key(step.front), step.front, step.before, step.arc, 0, -1, 0.0};
    if (step.before < 0) {
        std::ranges::fill(label_lost_, 0);
        take_arc(step.front.moving);
        take_arc(step.front.waiting);
        return;
    }
    const Label& before = labels_[at(step.before)];
    label_.cost = before.cost + step.turn_cost;
    label_.along_heading = before.along_heading;
    std::copy_n(lost_.data() + at(step.before) * words_, words_, label_lost_.data());
    if (step.arc >= 0) take_arc(step.arc);
}

void TandemSearch::sort_from(std::size_t first) {
    std::sort(open_.begin() + static_cast<std::ptrdiff_t>(first), open_.end(),
              [](const Step& a, const Step& b) { return a.bound > b.bound; });
}

void TandemSearch::begin(double tolerance) {
    const ResidualGraph& r = *residual_;
    const bool symmetric = relaxation_->symmetric();
    const int second = relaxation_->other(0);
    const auto cost = [&](int kind, int a) {
        return relaxation_->start(kind)[at(a)] + relaxation_->reduced()[at(a)];
    };
    open_.clear();
    for (int a = 0; a < r.size(); ++a) {
        if (cost(0, a) == kUnreachable) continue;
        for (int b = symmetric ? a + 1 : 0; b < r.size(); ++b) {
            const double reduced = cost(0, a) + cost(second, b);
            const double bound = reduced + onward_[0][at(a)] + onward_[at(second)][at(b)];
            if (!(bound < limit(tolerance)) || !abreast(a, b)) continue;
            const Front front = a < b ? Front{a, b, 0, false} : Front{b, a, second, false};
            open_.push_back({front, -1, -1, 0.0, reduced, bound});
        }
    }
    sort_from(0);
}

void TandemSearch::expand(const Step& step, int label, double tolerance) {
    const ResidualGraph& r = *residual_;
    const Front& front = step.front;
    const int kind = front.moving_kind;
    const int other_kind = relaxation_->other(kind);
    const bool may_end = relaxation_->may_end(r, kind, front.moving);
    if (front.ended && may_end && step.reduced < limit(tolerance) &&
        relaxation_->ends_fit(r.head[at(front.moving)], r.head[at(front.waiting)])) {
        offer(label);
    }
    const double below = limit(tolerance);
    const double other_way = front.ended ? 0.0 : onward_[at(other_kind)][at(front.waiting)];
    for (int p = r.out_start[at(front.moving)]; p < r.out_start[at(front.moving) + 1]; ++p) {
        const int next = r.out_arc[at(p)];
        const std::size_t number = at(number_[at(r.edge(next))]);
        if ((label_lost_[number / 64] >> (number % 64) & 1) != 0) continue;
        const double reduced = step.reduced + r.out_cost[at(p)] + relaxation_->reduced()[at(next)];
        const double bound = reduced + onward_[at(kind)][at(next)] + other_way;
        if (!(bound < below) || !abreast(next, front.waiting)) continue;
        const Front on = front.ended || next < front.waiting ? Front{next, front.waiting, kind, front.ended}
                                                             : Front{front.waiting, next, other_kind, false};
        open_.push_back({on, label, next, r.out_cost[at(p)], reduced, bound});
    }
    if (!front.ended && may_end && step.reduced + other_way < below) {
        open_.push_back({{front.waiting, front.moving, other_kind, true},
                         label,
                         -1,
                         0.0,
                         step.reduced,
                         step.reduced + other_way});
    }
}

bool TandemSearch::exhaust(const ResidualGraph& residual, double tolerance, std::int64_t budget,
                           const std::function<bool()>& stopped) {
    residual_ = &residual;
    for (int kind = 0; kind < relaxation_->system().kind_count; ++kind) {
        relaxation_->onward(residual, kind, onward_[at(kind)]);
    }
    number_edges();
    labels_.clear();
    lost_.clear();
    label_lost_.resize(words_);
    use_slots(kFewSlots);
    has_detours_ = false;
    begin(tolerance);
    if (open_.empty()) return true;
    gap_ = limit(tolerance) - open_.back().bound;
    bool is_small = true;
    while (!open_.empty()) {
        const Step step = open_.back();
        open_.pop_back();
        const double slack = limit(tolerance) - step.bound;
        if (!(slack > 0.0)) continue;
        if (--budget < 0 || (budget % kLabelsPerClock == 0 && stopped())) return false;
        if (is_small && labels_.size() > kFewLabels) {
            is_small = false;
            if (residual.size() <= kMostDetourArcs && !find_detours(stopped)) return false;
            use_slots(kManySlots);
        }
        take(step);
        if (dominated(slack)) continue;
        const auto index = static_cast<int>(labels_.size());
        label_.older = std::exchange(newest(label_.key), index);
        labels_.push_back(label_);
        lost_.insert(lost_.end(), label_lost_.begin(), label_lost_.end());
        const std::size_t first = open_.size();
        expand(step, index, tolerance);
        sort_from(first);
    }
    return true;
}

void TandemSearch::offer(int label) {
    chain_.clear();
    for (int l = label; l >= 0; l = labels_[at(l)].before) chain_.push_back(l);
    std::ranges::reverse(chain_);
    const Front& start = labels_[at(chain_.front())].front;
    std::array<int, 2> last{start.moving, start.waiting};
    for (std::size_t leg = 0; leg < 2; ++leg) legs_[leg].assign(1, residual_->arc[at(last[leg])]);
    for (std::size_t k = 1; k < chain_.size(); ++k) {
        const int arc = labels_[at(chain_[k])].arc;
        if (arc < 0) continue;
        const std::size_t leg = last[0] == labels_[at(chain_[k - 1])].front.moving ? 0 : 1;
        last[leg] = arc;
        legs_[leg].push_back(residual_->arc[at(arc)]);
    }
    incumbent_->offer(legs_[0], legs_[1]);
}

}  // namespace conelane::path_pair
