#include "solvers/path_pair/frontier/frontier_search.hpp"

#include <bit>

namespace conelane::path_pair {
namespace {

constexpr std::size_t kWorkPerSet = 5;     ///< of edges, in steps of the clock
constexpr std::size_t kSetsPerLabel = 20;  ///< its detours, along its arcs, take as long as so many

}  // namespace

bool FrontierSearch::out_of_time(std::size_t sets) {
    return clock_.tick(kWorkPerSet * sets);
}

void FrontierSearch::take(int arc, Label& label, std::uint64_t* lost) const {
    const std::uint64_t* const more = edges_.lost_after(arc);
    for (std::size_t w = 0; w < words_; ++w) lost[w] |= more[w];
    const int edge = frontiers_.residual().edge(arc);
    label.cost += graph_.cost(edge);
    if (graph_.along_heading(edge)) label.along_heading = std::min(2, label.along_heading + 1);
}

void FrontierSearch::wait(Label label) {
    const std::size_t frontier = to_index(label.frontier);
    label.next = std::exchange(waiting_[frontier], static_cast<int>(labels_.size()));
    open_[frontier / 64] |= std::uint64_t{1} << (frontier % 64);
    *labels_.add() = label;
}

void FrontierSearch::begin() {
    for (const int f : frontiers_.starts()) {
        if (out_of_time(1)) return;
        const double reduced = frontiers_.start_cost(f);
        if (!(reduced + frontiers_.onward(f) < limit())) continue;
        Label label{.before = -1,
                    .arc = -1,
                    .frontier = f,
                    .along_heading = 0,
                    .next = -1,
                    .cost = 0.0,
                    .reduced = reduced};
        std::uint64_t* const lost = lost_.add();
        std::fill_n(lost, words_, std::uint64_t{0});
        take(frontiers_.frontier(f).moving, label, lost);
        take(frontiers_.frontier(f).waiting, label, lost);
        wait(label);
    }
}

FrontierSearch::Outcome FrontierSearch::run(const Limits& limits) {
    if (clock_.out_of_time()) return Outcome::stopped;
    limits_ = limits;
    words_ = edges_.words();
    labels_.reset(1);
    lost_.reset(words_);
    waiting_.assign(to_index(frontiers_.size()), -1);
    open_.assign((to_index(frontiers_.size()) + 63) / 64, 0);
    wanted_.resize(words_);
    is_narrow_ = false;
    begin();
    if (clock_.expired()) return Outcome::stopped;
    again_ = true;
    while (again_) {
        again_ = false;
        for (std::size_t word = 0; word < open_.size(); ++word) {
            while (open_[word] != 0) {
                const int f = static_cast<int>(word * 64) + std::countr_zero(open_[word]);
                open_[word] &= open_[word] - 1;
                settle(f);
                if (clock_.expired()) return Outcome::stopped;
                if (labels_.size() > limits.max_labels) return Outcome::stopped;
            }
        }
    }
    return is_narrow_ ? Outcome::narrow : Outcome::exhausted;
}

/// Expands the labels that wait at a frontier.
void FrontierSearch::settle(int f) {
    here_.clear();
    for (int l = std::exchange(waiting_[to_index(f)], -1); l >= 0; l = label_at(l).next) here_.push_back(l);
    std::sort(here_.begin(), here_.end(), [&](int a, int b) { return label_at(a).cost < label_at(b).cost; });
    kept_along_heading_.clear();
    kept_lost_.clear();
    any_lost_.assign(words_, 0);
    for (const int l : here_) {
        const Label& label = label_at(l);
        if (!(label.reduced + frontiers_.onward(f) < limit())) continue;
        if (out_of_time(kSetsPerLabel + kept_along_heading_.size())) return;
        const int most = tables_.quanta_below(limit() - label.reduced - frontiers_.onward(f));
        if (tables_.have_detours() && detour_reaches_limit(l, most)) continue;
        if (dominated(label, lost(l), most)) continue;
        if (kept_along_heading_.size() >= limits_.width) {
            is_narrow_ = true;
            return;
        }
        kept_along_heading_.push_back(label.along_heading);
        kept_lost_.insert(kept_lost_.end(), lost(l), lost(l) + words_);
        for (std::size_t w = 0; w < words_; ++w) any_lost_[w] |= lost(l)[w];
        if (frontiers_.is_last(f) && label.along_heading >= 2 && label.cost < incumbent_.limit()) {
            offer(l);
        }
        expand(l);
    }
}

/// Whether every walk on that uses none of the edges lost by some arc of the label has a detour above `most`.
bool FrontierSearch::detour_reaches_limit(int l, int most) const {
    const int f = label_at(l).frontier;
    for (;; l = label_at(l).before) {
        const Label& label = label_at(l);
        if (label.arc >= 0 && tables_.detour(f, label.arc) > most) return true;
        if (label.before >= 0) continue;
        const FrontierGraph::Frontier& start = frontiers_.frontier(label.frontier);
        return tables_.detour(f, start.moving) > most || tables_.detour(f, start.waiting) > most;
    }
}

/// True if a kept label dominates this one: it costs no more, and has every edge that this label needs.
/// Completions below the limit use no edge with a regret above `most`.
bool FrontierSearch::dominated(const Label& label, const std::uint64_t* lost, int most) {
    const Quanta* regret = tables_.regrets(label.frontier);
    for (std::size_t w = 0; w < words_; ++w, regret += 64) {
        wanted_[w] = any_lost_[w] & ~lost[w];
        for (std::uint64_t bits = wanted_[w]; bits != 0; bits &= bits - 1) {
            if (regret[std::countr_zero(bits)] > most) wanted_[w] ^= bits & (~bits + 1);
        }
    }
    const std::uint64_t* rival = kept_lost_.data();
    for (const int along_heading : kept_along_heading_) {
        std::uint64_t missing = 0;
        for (std::size_t w = 0; w < words_; ++w) missing |= rival[w] & wanted_[w];
        if (missing == 0 && along_heading >= label.along_heading) return true;
        rival += words_;
    }
    return false;
}

void FrontierSearch::expand(int l) {
    const Label label = label_at(l);
    for (const FrontierGraph::Step& step : frontiers_.steps(label.frontier)) {
        const double reduced = label.reduced + frontiers_.cost(step);
        if (!(reduced + frontiers_.onward(step.to) < limit())) continue;
        if (step.arc >= 0 && EdgeSets::contains(lost(l), edges_.number(step.arc))) continue;
        Label on = label;
        on.before = l;
        on.arc = step.arc;
        on.frontier = step.to;
        on.cost += step.turn;
        on.reduced = reduced;
        std::uint64_t* const lost_on = lost_.add();
        std::copy_n(lost(l), words_, lost_on);
        if (step.arc >= 0) take(step.arc, on, lost_on);
        wait(on);
        again_ |= step.to / 64 < label.frontier / 64;
    }
}

void FrontierSearch::offer(int label) {
    const ResidualGraph& residual = frontiers_.residual();
    chain_.clear();
    for (int l = label; l >= 0; l = label_at(l).before) chain_.push_back(l);
    std::ranges::reverse(chain_);
    const FrontierGraph::Frontier& start = frontiers_.frontier(label_at(chain_.front()).frontier);
    std::array<int, 2> last{start.moving, start.waiting};
    for (std::size_t leg = 0; leg < 2; ++leg) legs_[leg].assign(1, residual.arc[to_index(last[leg])]);
    for (std::size_t k = 1; k < chain_.size(); ++k) {
        const int arc = label_at(chain_[k]).arc;
        if (arc < 0) continue;
        const std::size_t leg =
            last[0] == frontiers_.frontier(label_at(chain_[k - 1]).frontier).moving ? 0 : 1;
        last[leg] = arc;
        legs_[leg].push_back(residual.arc[to_index(arc)]);
    }
    incumbent_.offer(legs_[0], legs_[1]);
}

}  // namespace conelane::path_pair
