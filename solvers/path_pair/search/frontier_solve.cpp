#include "solvers/path_pair/search/frontier_solve.hpp"

#include "solvers/path_pair/graph/to_index.hpp"

#include <algorithm>

namespace conelane::path_pair {

void FrontierSolve::bind(PairRelaxation& relaxation, double tolerance, SearchClock& clock) {
    relaxation_ = &relaxation;
    tolerance_ = tolerance;
    clock_ = &clock;
    fronts_.bind(relaxation, clock);
    search_.bind(graph_, relaxation, incumbent_, clock);
    beam_.bind(graph_, relaxation, incumbent_, clock);
}

Verdict FrontierSolve::search_by_target(const ResidualGraph& graph, const TargetLimits& limits,
                                        double& bound) {
    const double incumbent = incumbent_.cutoff();
    for (const double share : tuning().targets) {
        const double target = bound + share * (incumbent - bound);
        if (share < 1.0 && incumbent - target < tuning().min_target_gap) continue;
        const Verdict verdict = search_below(graph, target, limits.fronts, bound);
        for (const double part : tuning().lower_targets) {
            const double step = part * (target - bound);
            if (verdict != Verdict::open || !limits.lowers_targets || incumbent_.cutoff() < target ||
                step < tuning().min_target_gap)
                break;
            if (search_below(graph, bound + step, limits.fronts, bound) == Verdict::closed) break;
        }
        if (incumbent_.cutoff() < target || verdict != Verdict::closed) return verdict;
    }
    return Verdict::closed;
}

/// All pairs of the node that cost less than the target, which is not above the incumbent. Where there is
/// none the target is the node's bound; a pair that is found is the incumbent from then on.
Verdict FrontierSolve::search_below(const ResidualGraph& graph, double target, std::size_t max_fronts,
                                    double& bound) {
    const double incumbent = incumbent_.cutoff();
    incumbent_.set_cutoff(target);
    const Verdict verdict = search(graph, {max_fronts, tuning().max_labels});
    if (incumbent_.cutoff() < target) return verdict;
    incumbent_.set_cutoff(incumbent);
    if (verdict == Verdict::closed) bound = std::max(bound, target - tolerance_);
    return verdict;
}

Verdict FrontierSolve::search(const ResidualGraph& graph, const Limits& limits) {
    if (const std::optional<Verdict> verdict = build(graph, limits)) return *verdict;
    const std::size_t max_rows = tuning().max_table_bytes / OnwardTables::row_bytes(graph);
    if (limits.fronts != kAny && to_index(fronts_.size()) > max_rows) return Verdict::open;
    if (limits.labels == kAny) return search_built(kAny);
    return search_built(
        std::min(limits.labels, tuning().max_label_words / std::max<std::size_t>(1, edge_sets_.words())));
}

/// The fronts, less what can be dropped. A verdict where none of them has to be searched, or none can.
std::optional<Verdict> FrontierSolve::build(const ResidualGraph& graph, const Limits& limits) {
    const bool drop_dominated = options_.drop_dominated_edges;
    edge_sets_.assign(graph_, graph, *clock_);
    if (limits.beam_width > 0) run_beam(graph, limits.beam_width);
    if (clock_->struck()) return Verdict::stopped;
    dominated_edges_.find(graph, *relaxation_, edge_sets_, drop_dominated, *clock_);
    if (clock_->struck()) return Verdict::stopped;
    const bool built = fronts_.build(graph, dominated_edges_, limit(), limits.fronts,
                                     drop_dominated ? &edge_sets_ : nullptr);
    clock_->out_of_time(tuning().work_per_front * to_index(fronts_.size()));
    if (!built) return clock_->out_of_time() ? Verdict::stopped : Verdict::open;
    double bound = fronts_.find_onward(limit());
    if (drop_dominated && bound < limit()) {
        fronts_.drop(limit());
        fronts_.drop_dominated_edges(edge_sets_);
        fronts_.find_forward();
        bound = fronts_.find_onward(limit());
    }
    if (clock_->out_of_time()) return Verdict::stopped;
    if (!(bound < limit())) return Verdict::closed;
    fronts_.drop(limit());
    return std::nullopt;
}

/// Labels on the fronts. On many of them first a few at each: an incumbent drops many fronts.
Verdict FrontierSolve::search_built(std::size_t max_labels) {
    const bool is_wide = fronts_.size() >= tuning().wide_fronts;
    find_tables();
    for (const std::size_t width : {tuning().narrow_labels, FrontierSearch::kAnyWidth}) {
        if (clock_->out_of_time()) return Verdict::stopped;
        if (width == tuning().narrow_labels && !is_wide) continue;
        const double before = incumbent_.cutoff();
        const FrontierSearch::Outcome outcome =
            search_.run(fronts_, edge_sets_, onward_tables_, {tolerance_, width, max_labels});
        if (outcome == FrontierSearch::Outcome::exhausted) return Verdict::closed;
        if (outcome == FrontierSearch::Outcome::stopped) break;
        if (incumbent_.cutoff() < before) {
            fronts_.drop(limit());
            find_tables();
        }
    }
    return clock_->out_of_time() ? Verdict::stopped : Verdict::open;
}

void FrontierSolve::find_tables() {
    onward_tables_.find(fronts_, edge_sets_, limit(), fronts_.size() >= tuning().wide_fronts, *clock_);
}

}  // namespace conelane::path_pair
