#include "solvers/path_pair/search/frontier_solve.hpp"

namespace conelane::path_pair {

Verdict FrontierSolve::search_by_target(const ResidualGraph& graph, const TargetLimits& limits,
                                        double& bound) {
    const double incumbent = incumbent_.cutoff();
    for (const double share : tuning().targets) {
        const double target = bound + share * (incumbent - bound);
        if (share < 1.0 && incumbent - target < tuning().min_target_gap) continue;
        const Verdict verdict = search_below(graph, target, limits.frontiers, bound);
        for (const double part : tuning().lower_targets) {
            const double step = part * (target - bound);
            if (verdict != Verdict::open || !limits.lowers_targets || incumbent_.cutoff() < target ||
                step < tuning().min_target_gap)
                break;
            if (search_below(graph, bound + step, limits.frontiers, bound) == Verdict::closed) break;
        }
        if (incumbent_.cutoff() < target || verdict != Verdict::closed) return verdict;
    }
    return Verdict::closed;
}

/// Finds all pairs of the node that cost less than the target, which is not above the incumbent. A pair that
/// is found becomes the incumbent; without one, the target is the node's bound.
Verdict FrontierSolve::search_below(const ResidualGraph& graph, double target, std::size_t max_frontiers,
                                    double& bound) {
    const double incumbent = incumbent_.cutoff();
    incumbent_.set_cutoff(target);
    const Verdict verdict = search(graph, {max_frontiers, tuning().max_labels});
    if (incumbent_.cutoff() < target) return verdict;
    incumbent_.set_cutoff(incumbent);
    if (verdict == Verdict::closed) bound = std::max(bound, target - incumbent_.tolerance());
    return verdict;
}

Verdict FrontierSolve::search(const ResidualGraph& graph, const Limits& limits) {
    if (const std::optional<Verdict> verdict = build(graph, limits)) return *verdict;
    const std::size_t max_rows = tuning().max_table_bytes / OnwardTables::row_bytes(graph);
    if (limits.frontiers != kAny && to_index(frontiers_.size()) > max_rows) return Verdict::open;
    if (limits.labels == kAny) return search_built(kAny);
    return search_built(
        std::min(limits.labels, tuning().max_label_words / std::max<std::size_t>(1, edge_sets_.words())));
}

/// Builds the frontiers and drops what it can. Returns a verdict if no frontier needs, or allows, a search.
std::optional<Verdict> FrontierSolve::build(const ResidualGraph& graph, const Limits& limits) {
    const bool drop_dominated = options_.drop_dominated_edges;
    edge_sets_.assign(graph_, graph, clock_);
    if (limits.beam_width > 0) run_beam(graph, limits.beam_width);
    if (clock_.expired()) return Verdict::stopped;
    dominated_edges_.find(graph, relaxation_, edge_sets_, drop_dominated, clock_);
    if (clock_.expired()) return Verdict::stopped;
    const bool built = frontiers_.build(graph, dominated_edges_, limit(), limits.frontiers,
                                        drop_dominated ? &edge_sets_ : nullptr);
    clock_.out_of_time(tuning().work_per_frontier * to_index(frontiers_.size()));
    if (!built) return clock_.out_of_time() ? Verdict::stopped : Verdict::open;
    double bound = frontiers_.find_onward(limit());
    if (drop_dominated && bound < limit()) {
        frontiers_.drop(limit());
        frontiers_.drop_dominated_edges(edge_sets_);
        frontiers_.find_forward();
        bound = frontiers_.find_onward(limit());
    }
    if (clock_.out_of_time()) return Verdict::stopped;
    if (!(bound < limit())) return Verdict::closed;
    frontiers_.drop(limit());
    return std::nullopt;
}

/// Labels on the frontiers. If there are many, a narrow search comes first: an incumbent drops many.
Verdict FrontierSolve::search_built(std::size_t max_labels) {
    const bool was_wide = is_wide();
    find_tables();
    for (const std::size_t width : {tuning().narrow_labels, FrontierSearch::kAnyWidth}) {
        if (clock_.out_of_time()) return Verdict::stopped;
        if (width == tuning().narrow_labels && !was_wide) continue;
        const double before = incumbent_.cutoff();
        const FrontierSearch::Outcome outcome = search_.run({width, max_labels});
        if (outcome == FrontierSearch::Outcome::exhausted) return Verdict::closed;
        if (outcome == FrontierSearch::Outcome::stopped) break;
        if (incumbent_.cutoff() < before) {
            frontiers_.drop(limit());
            find_tables();
        }
    }
    return clock_.out_of_time() ? Verdict::stopped : Verdict::open;
}

}  // namespace conelane::path_pair
