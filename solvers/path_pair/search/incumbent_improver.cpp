#include "solvers/path_pair/search/incumbent_improver.hpp"

#include "solvers/path_pair/graph/to_index.hpp"

#include <algorithm>
#include <cmath>

namespace conelane::path_pair {

IncumbentImprover::IncumbentImprover(const ArcGraph& graph, Incumbent& incumbent,
                                     const PathPairOptions& options)
    : graph_(graph), incumbent_(incumbent), options_(options), ascent_(graph, pair_, options) {}

void IncumbentImprover::begin(const LegSystem& system, std::span<const char> starting, CliquePool& cliques,
                              SecondLegBound& second_leg, double tolerance, SearchClock& clock) {
    system_ = &system;
    starting_ = starting;
    cliques_ = &cliques;
    second_leg_ = &second_leg;
    tolerance_ = tolerance;
    clock_ = &clock;
    pair_.reset(graph_, 0.0);
    has_pair_ = false;
    new_window_arcs_.reset();
    phase_ = 0;
    start_costs_.clear();
    own_work_ = 0;
    idle_beams_ = 0;
    aim_ = {};
    has_whole_ = false;
    has_beam_ = false;
}

void IncumbentImprover::improve(const ResidualGraph& alive, double bound) {
    look_at_incumbent();
    const double gap = (incumbent_.cutoff() - bound) / std::max(1.0, std::abs(incumbent_.cutoff()));
    const bool is_wanted = options_.search_windows && options_.search_frontiers && system_->kind_count == 1;
    if (is_wanted && may_work(gap, own_work_)) work(alive, gap);
}

void IncumbentImprover::look_at_incumbent() {
    const bool is_new = incumbent_.cutoff() < aim_.known_cost;
    aim_.known_cost = incumbent_.cutoff();
    if (!is_new) return;
    aim_.outside_cost = incumbent_.cutoff();
    // Windows are of the system from near to far: a start of another system cannot be improved there.
    if (!incumbent_.goes_far()) return;
    pair_ = incumbent_;
    has_pair_ = true;
    new_window_arcs_ = tuning().new_pair_arcs;
}

/// At once for huge graphs; otherwise a share of the work on bounds, which grows with the gap.
bool IncumbentImprover::may_work(double gap, std::int64_t own_work) const {
    const WindowTuning& t = tuning();
    const auto other = static_cast<double>(clock_->total_work() - own_work);
    const double wide = std::clamp((gap - t.narrow_gap) / (t.wide_gap - t.narrow_gap),
                                   t.min_share_of_more_work / t.share_of_more_work, 1.0);
    const double at_once = idle_beams_ < t.max_idle_beams
                               ? t.work_per_huge_arc * std::max(0, graph_.arc_count() - t.huge_graph_arcs)
                               : 0.0;
    const double allowed = at_once + t.share_of_little_work * std::min(other, t.little_work) +
                           t.share_of_more_work * wide * std::max(0.0, other - t.little_work);
    return phase_ < t.phases.size() && static_cast<double>(own_work) + t.min_work < allowed;
}

void IncumbentImprover::work(const ResidualGraph& alive, double gap) {
    cut_from(alive);
    const std::int64_t others = clock_->total_work() - own_work_;
    while (may_work(gap, clock_->total_work() - others) && !clock_->out_of_time()) {
        if (has_pair_) {
            has_pair_ = search_window();
        } else {
            begin_phase();
        }
        if (pair_.found() && pair_.cutoff() < incumbent_.cutoff()) incumbent_ = pair_;
    }
    aim_.known_cost = incumbent_.cutoff();
    own_work_ = clock_->total_work() - others;
}

void IncumbentImprover::cut_from(const ResidualGraph& alive) {
    if (!has_whole_) has_whole_ = whole_.assign(graph_, starting_, *clock_);
    usable_.assign(to_index(graph_.arc_count()), 0);
    for (const int arc : alive.arc) usable_[to_index(arc)] = 1;
    window_.assign(graph_, *system_, whole_, usable_);
    no_decisions_.reset(graph_);
    if (!new_window_arcs_) return;
    window_.restart(*new_window_arcs_);
    new_window_arcs_.reset();
}

/// The next pair to improve, if it is one that was not improved before.
void IncumbentImprover::begin_phase() {
    const WindowPhase& phase = tuning().phases[phase_++];
    if (phase.beam_width == 0) {
        if (!incumbent_.goes_far()) return;
        pair_ = incumbent_;
    } else {
        pair_.reset(graph_, 0.0);
        if (!has_beam_) beam_.begin(graph_, *system_, *clock_);
        has_beam_ = true;
        beam_.run({phase.beam_width, phase.beam_max_at_cone}, pair_, *clock_);
        if (!pair_.found() || std::ranges::find(start_costs_, pair_.cutoff()) != start_costs_.end()) {
            ++idle_beams_;
            return;
        }
        idle_beams_ = 0;
        start_costs_.push_back(pair_.cutoff());
    }
    window_.restart(phase.window_arcs);
    has_pair_ = true;
}

/// False if no window is left that might improve the pair.
bool IncumbentImprover::search_window() {
    if (!window_.next(pair_.legs(), order_)) return false;
    clock_->out_of_time(whole_.arc.size() + whole_.out_arc.size() / 8);
    keep_successor_.assign(whole_.out_arc.size(), 1);
    node_.graph.filter(whole_, order_, keep_successor_, index_);
    node_.multipliers.cone.assign(to_index(graph_.cone_count()), 0.0);
    node_.multipliers.clique.assign(to_index(cliques_->size()), 0.0);
    node_.multipliers.heading = 0.0;
    node_.bound = -kUnreachable;
    node_.max_steps = tuning().max_steps;
    ascent_.bind(window_.system(), {*cliques_, no_decisions_, *second_leg_, tolerance_, *clock_});
    const double before = pair_.cutoff();
    const NodeAscent::Rules rules{options_.tuning.ascent.node, {tuning().max_frontiers, false}, false};
    if (ascent_.run(node_, rules) == Verdict::open) {
        ascent_.frontiers().run_beam(node_.graph, tuning().beam_width);
    }
    window_.report(pair_.cutoff() < before);
    return true;
}

}  // namespace conelane::path_pair
