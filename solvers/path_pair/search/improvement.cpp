// Incumbents from small parts of the graph, part of BranchAndBound.

#include "solvers/path_pair/graph/to_index.hpp"
#include "solvers/path_pair/search/branch_and_bound.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace conelane::path_pair {
namespace {

/// Pairs are improved one after the other: what a beam of this width finds, or, where that is 0, the best
/// one.
struct Phase {
    PairBeam::Limits beam;
    std::size_t window_arcs;
};
constexpr Phase kPhases[] = {{{64, 3}, 100},   {{0, 0}, 200},    {{64, 8}, 100},   {{64, 16}, 100},
                             {{0, 0}, 300},    {{128, 8}, 150},  {{128, 16}, 150}, {{0, 0}, 450},
                             {{256, 16}, 150}, {{256, 32}, 150}, {{0, 0}, 700},    {{512, 32}, 200}};
constexpr std::size_t kWindowArcs = 100;  ///< around an incumbent that comes from elsewhere
constexpr int kWindowSteps = 15;
constexpr std::size_t kWindowBeamWidth = 8;

// In steps of the search's clock, about a nanosecond each.
constexpr double kLittleWork = 10e6;
constexpr double kMinWork = 0.3e6;          ///< not worth beginning with less
constexpr double kShareOfLittleWork = 0.1;  ///< of the work on bounds, so long
constexpr double kWorkPerHugeArc =
    50e3;  ///< at once, for each arc above the next number: the bound comes late
constexpr int kHugeGraph = 1000;
// Where the bound is far away no proof will come soon, and the incumbent may be poor.
constexpr double kShareOfMoreWork = 1.0;
constexpr double kMinShare = 0.1;
constexpr double kNarrowGap = 0.1;  ///< of the incumbent's cost
constexpr double kWideGap = 0.5;

}  // namespace

void BranchAndBound::begin_improvement() {
    Improvement& state = improvement_;
    state.phase = 0;
    state.needs_start = true;
    state.has_whole = false;
    state.known_cost = state.outside_cost = kUnreachable;
    state.start_costs.clear();
    state.work = 0;
    in_window_ = false;
    state.best.reset(graph_, 0.0);
    state.pair.reset(graph_, 0.0);
}

bool BranchAndBound::may_improve(double gap) const {
    const std::int64_t total = clock_->total_work();
    const std::int64_t own = improvement_.work + (in_window_ ? total - improvement_.entered : 0);
    const auto other = static_cast<double>(total - own);
    const double wide =
        std::clamp((gap - kNarrowGap) / (kWideGap - kNarrowGap), kMinShare / kShareOfMoreWork, 1.0);
    const double allowed = kWorkPerHugeArc * std::max(0, graph_.arc_count() - kHugeGraph) +
                           kShareOfLittleWork * std::min(other, kLittleWork) +
                           kShareOfMoreWork * wide * std::max(0.0, other - kLittleWork);
    return improvement_.phase < static_cast<int>(std::size(kPhases)) &&
           static_cast<double>(own) + kMinWork < allowed;
}

void BranchAndBound::improve_incumbent(const ResidualGraph& alive, double bound) {
    Improvement& state = improvement_;
    const bool is_new = incumbent_.cutoff() < state.known_cost;
    if (is_new) state.outside_cost = incumbent_.cutoff();
    state.known_cost = incumbent_.cutoff();
    const double gap = (incumbent_.cutoff() - bound) / std::max(1.0, std::abs(incumbent_.cutoff()));
    if (!options_.search_windows || !options_.search_frontiers || whole_system_->kind_count != 1) return;
    if (is_new && incumbent_.goes_far()) {
        state.pair = incumbent_;
        state.window_arcs = kWindowArcs;
        state.is_new = true;
        state.needs_start = false;
    }
    if (!may_improve(gap)) return;
    decisions_.reset(graph_);
    enter_windows(alive);
    while (may_improve(gap) && !clock_->out_of_time()) {
        if (state.needs_start) {
            begin_phase();
        } else {
            state.needs_start = !search_window();
        }
        if (incumbent_.found() && incumbent_.cutoff() < state.best.cutoff()) state.best = incumbent_;
    }
    leave_windows();
}

/// From here on `incumbent_` is the pair that is improved, and the best one is kept aside.
void BranchAndBound::enter_windows(const ResidualGraph& alive) {
    Improvement& state = improvement_;
    if (!state.has_whole) state.has_whole = whole_.assign(graph_, starting_, *clock_);
    std::vector<char>& usable = edge_alive_;
    usable.assign(to_index(graph_.arc_count()), 0);
    for (const int arc : alive.arc) usable[to_index(arc)] = 1;
    window_.assign(graph_, *whole_system_, whole_, usable);
    if (std::exchange(state.is_new, false)) window_.restart(state.window_arcs);
    state.multipliers = multipliers_;
    state.edge_use = edge_use_;
    state.end_use = end_use_;
    state.ascent = ascent_;
    state.entered = clock_->total_work();
    std::swap(relaxation_, window_relaxation_);
    state.best = incumbent_;
    std::swap(incumbent_, state.pair);
    in_window_ = true;
}

void BranchAndBound::leave_windows() {
    Improvement& state = improvement_;
    in_window_ = false;
    std::swap(incumbent_, state.pair);
    incumbent_ = state.best;
    state.known_cost = incumbent_.cutoff();
    std::swap(relaxation_, window_relaxation_);
    state.work += clock_->total_work() - state.entered;
    multipliers_ = state.multipliers;
    multipliers_.clique.resize(to_index(cliques_.size()), 0.0);
    edge_use_ = state.edge_use;
    end_use_ = state.end_use;
    ascent_ = state.ascent;
}

void BranchAndBound::begin_phase() {
    Improvement& state = improvement_;
    const Phase& phase = kPhases[state.phase++];
    if (phase.beam.width == 0) {
        // Windows are of the system from near to far: a start of another system cannot be improved there.
        if (!state.best.goes_far()) return;
        incumbent_ = state.best;
    } else {
        incumbent_.reset(graph_, 0.0);
        pair_beam_.run(graph_, *whole_system_, phase.beam, incumbent_, *clock_);
        if (!incumbent_.found() ||
            std::ranges::find(state.start_costs, incumbent_.cutoff()) != state.start_costs.end()) {
            return;
        }
        state.start_costs.push_back(incumbent_.cutoff());
    }
    window_.restart(phase.window_arcs);
    state.needs_start = false;
}

/// False where the pair has no window left that might improve it.
bool BranchAndBound::search_window() {
    if (!window_.next(incumbent_.legs(), order_)) return false;
    relaxation_.bind(graph_, window_.system(), cliques_, decisions_, *clock_);
    keep_successor_.assign(whole_.out_arc.size(), 1);
    clock_->out_of_time(whole_.arc.size() + whole_.out_arc.size() / 8);
    window_node_.graph.filter(whole_, order_, keep_successor_, index_);
    window_node_.multipliers.cone.assign(to_index(graph_.cone_count()), 0.0);
    window_node_.multipliers.clique.assign(to_index(cliques_.size()), 0.0);
    window_node_.multipliers.heading = 0.0;
    window_node_.bound = -kUnreachable;
    window_node_.max_steps = kWindowSteps;
    std::ranges::fill(edge_use_, 0.0);
    std::ranges::fill(end_use_, 0.0);
    const double before = incumbent_.cutoff();
    if (ascend(window_node_, false) == Verdict::open) {
        beam_.run(window_node_.graph, edge_sets_, tolerance_, kWindowBeamWidth);
    }
    window_.report(incumbent_.cutoff() < before);
    return true;
}

}  // namespace conelane::path_pair
