#include "solvers/path_pair/search/incumbent_improver.hpp"

namespace conelane::path_pair {

IncumbentImprover::IncumbentImprover(const ArcGraph& graph, const LegSystem& system, Incumbent& incumbent,
                                     const PathPairOptions& options, CliquePool& cliques,
                                     SecondLegBound& second_leg, SearchClock& clock)
    : graph_(graph),
      system_(system),
      incumbent_(incumbent),
      options_(options),
      cliques_(cliques),
      clock_(clock),
      pair_(graph),
      window_(graph, system, whole_),
      beam_(graph, system, clock),
      ascent_({.graph = graph,
               .system = window_.system(),
               .incumbent = pair_,
               .options = options,
               .cliques = cliques,
               .decisions = no_decisions_,
               .second_leg = second_leg,
               .clock = clock}) {}

void IncumbentImprover::restart() {
    state_ = {};
    pair_.reset(0.0, incumbent_.tolerance());
    start_costs_.clear();
}

void IncumbentImprover::improve(const ResidualGraph& alive, double bound) {
    look_at_incumbent();
    const double gap = (incumbent_.cutoff() - bound) / std::max(1.0, std::abs(incumbent_.cutoff()));
    const bool is_wanted = options_.search_windows && options_.search_frontiers && system_.kind_count == 1;
    if (is_wanted && may_work(gap, state_.own_work)) work(alive, gap);
}

void IncumbentImprover::look_at_incumbent() {
    const bool is_new = incumbent_.cutoff() < state_.aim.known_cost;
    state_.aim.known_cost = incumbent_.cutoff();
    if (!is_new) return;
    state_.aim.outside_cost = incumbent_.cutoff();
    // Windows are of the system from near to far: a start of another system cannot be improved there.
    if (!incumbent_.goes_far()) return;
    pair_ = incumbent_;
    state_.has_pair = true;
    state_.new_window_arcs = tuning().new_pair_arcs;
}

/// At once for huge graphs; otherwise a share of the work on bounds, which grows with the gap.
bool IncumbentImprover::may_work(double gap, std::int64_t own_work) const {
    const WindowTuning& t = tuning();
    const auto other = static_cast<double>(clock_.total_work() - own_work);
    const double wide = std::clamp((gap - t.narrow_gap) / (t.wide_gap - t.narrow_gap),
                                   t.min_share_of_more_work / t.share_of_more_work, 1.0);
    const double at_once = state_.idle_beams < t.max_idle_beams
                               ? t.work_per_huge_arc * std::max(0, graph_.arc_count() - t.huge_graph_arcs)
                               : 0.0;
    const double allowed = at_once + t.share_of_little_work * std::min(other, t.little_work) +
                           t.share_of_more_work * wide * std::max(0.0, other - t.little_work);
    return state_.phase < t.phases.size() && static_cast<double>(own_work) + t.min_work < allowed;
}

void IncumbentImprover::work(const ResidualGraph& alive, double gap) {
    cut_from(alive);
    const std::int64_t others = clock_.total_work() - state_.own_work;
    while (may_work(gap, clock_.total_work() - others) && !clock_.out_of_time()) {
        if (state_.has_pair) {
            state_.has_pair = search_window();
        } else {
            begin_phase();
        }
        if (pair_.found() && pair_.cutoff() < incumbent_.cutoff()) incumbent_ = pair_;
    }
    state_.aim.known_cost = incumbent_.cutoff();
    state_.own_work = clock_.total_work() - others;
}

void IncumbentImprover::cut_from(const ResidualGraph& alive) {
    if (!state_.has_whole) state_.has_whole = whole_.assign(graph_, system_.kinds[0].start, clock_);
    usable_.assign(to_index(graph_.arc_count()), 0);
    for (const int arc : alive.arc) usable_[to_index(arc)] = 1;
    window_.assign(usable_);
    no_decisions_.reset(graph_);
    if (!state_.new_window_arcs) return;
    window_.restart(*state_.new_window_arcs);
    state_.new_window_arcs.reset();
}

/// The next pair to improve, if it is one that was not improved before.
void IncumbentImprover::begin_phase() {
    const WindowPhase& phase = tuning().phases[state_.phase++];
    if (phase.beam_width == 0) {
        if (!incumbent_.goes_far()) return;
        pair_ = incumbent_;
    } else {
        pair_.reset(0.0, incumbent_.tolerance());
        if (!std::exchange(state_.has_first_steps, true)) beam_.find_first_steps();
        beam_.run({phase.beam_width, phase.beam_max_at_cone}, pair_);
        if (!pair_.found() || std::ranges::find(start_costs_, pair_.cutoff()) != start_costs_.end()) {
            ++state_.idle_beams;
            return;
        }
        state_.idle_beams = 0;
        start_costs_.push_back(pair_.cutoff());
    }
    window_.restart(phase.window_arcs);
    state_.has_pair = true;
}

/// False if no window is left that might improve the pair.
bool IncumbentImprover::search_window() {
    if (!window_.next(pair_.legs(), order_)) return false;
    clock_.out_of_time(whole_.arc.size() + whole_.out_arc.size() / 8);
    keep_successor_.assign(whole_.out_arc.size(), 1);
    node_.graph.filter(whole_, order_, keep_successor_, index_);
    node_.restart(graph_, cliques_.size());
    node_.max_steps = tuning().max_steps;
    ascent_.restart();
    const double before = pair_.cutoff();
    const NodeAscent::Rules rules{.patience = options_.tuning.ascent.node,
                                  .last_search = {tuning().max_frontiers, false},
                                  .separates_cliques = false};
    if (ascent_.run(node_, rules) == Verdict::open) {
        ascent_.frontiers().run_beam(node_.graph, tuning().beam_width);
    }
    window_.report(pair_.cutoff() < before);
    return true;
}

}  // namespace conelane::path_pair
