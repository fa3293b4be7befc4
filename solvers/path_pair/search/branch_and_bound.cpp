#include "solvers/path_pair/search/branch_and_bound.hpp"

namespace conelane::path_pair {

BranchAndBound::BranchAndBound(const ArcGraph& graph, const LegSystem& system, Incumbent& incumbent,
                               const PathPairOptions& options, SearchClock& clock)
    : graph_(graph),
      system_(system),
      incumbent_(incumbent),
      options_(options),
      clock_(clock),
      second_leg_(graph, clock),
      ascent_({.graph = graph,
               .system = system,
               .incumbent = incumbent,
               .options = options,
               .cliques = cliques_,
               .decisions = decisions_,
               .second_leg = second_leg_,
               .clock = clock}),
      improver_(graph, system, incumbent, options, cliques_, second_leg_, clock),
      brancher_(graph, options.tuning.branching),
      queue_(options.tuning.branching.max_open_nodes) {}

BranchAndBound::Outcome BranchAndBound::run() {
    restart();
    root_.bound = graph_.share_bound();
    ++nodes_;
    double open_bound = kUnreachable;
    if (explore(root_) == Verdict::stopped) open_bound = root_.bound;
    while (open_bound == kUnreachable && !queue_.empty()) {
        std::unique_ptr<Node> next = queue_.take_next();
        improver_.improve(root_.graph, next->bound);
        if (next->bound < incumbent_.limit()) {
            ++nodes_;
            if (explore(*next) == Verdict::stopped) open_bound = std::min(next->bound, queue_.min_bound());
        }
        queue_.give_back(std::move(next));
    }
    return {std::min(open_bound, incumbent_.limit()), open_bound == kUnreachable};
}

/// Bounds and searches the node, and branches where that leaves it open.
Verdict BranchAndBound::explore(Node& node) {
    take_decisions(node);
    Verdict verdict = &node == &root_ ? ascend_root() : ascend(node);
    if (verdict != Verdict::open) return verdict;
    const Branching branching =
        brancher_.choose(node.graph, ascent_.relaxation(), decisions_, ascent_.usage());
    if (branching.on != Branching::On::nothing) {
        add_children(node, branching);
        return Verdict::open;
    }
    // With every edge decided nothing is left to branch on: one pair of paths at most.
    verdict = ascent_.frontiers().search(node.graph, {});
    return verdict == Verdict::closed ? Verdict::closed : Verdict::stopped;
}

Verdict BranchAndBound::ascend(Node& node) {
    const FrontierTuning& tuning = options_.tuning.frontiers;
    return ascent_.run(
        node, {.patience = options_.tuning.ascent.node, .last_search = {tuning.max_frontiers, true}});
}

/// With windows for incumbents between the steps.
Verdict BranchAndBound::ascend_root() {
    const FrontierTuning& tuning = options_.tuning.frontiers;
    const WindowTuning& windows = options_.tuning.windows;
    const bool has_first_beam =
        root_.graph.size() >= tuning.first_beam_min_arcs && root_.graph.size() < tuning.first_beam_end_arcs;
    const bool is_huge = graph_.arc_count() >= windows.huge_graph_arcs;
    root_.max_steps = options_.root_steps;
    ascent_.begin(root_, {.patience = options_.tuning.ascent.root,
                          .last_search = {tuning.max_frontiers, true},
                          .smooths = system_.kind_count == 1,
                          .first_try = has_first_beam ? 0 : 1});
    Verdict verdict = Verdict::open;
    while (verdict == Verdict::open && !ascent_.is_done()) {
        if (is_huge || ascent_.steps() >= windows.first_step) improver_.improve(root_.graph, root_.bound);
        verdict = ascent_.step(root_, improver_.aim());
    }
    return verdict;
}

void BranchAndBound::take_decisions(const Node& node) {
    decisions_.reset(graph_);
    for (const auto& [branching, in] : node.decisions) {
        if (branching.on == Branching::On::end) {
            decisions_.decide_end(branching.what, in ? Decisions::End::always : Decisions::End::never);
        } else if (in) {
            decisions_.require_edge(graph_, branching.what);
        }
    }
}

/// On an end: first all pairs that have it, then the rest, from the same multipliers.
void BranchAndBound::add_children(const Node& parent, const Branching& branching) {
    const bool in_first = brancher_.is_in_first(branching);
    for (const bool in : {!in_first, in_first}) {  // the last one comes next
        Node& child = queue_.add();
        brancher_.branch(parent.graph, branching, in, child.graph);
        child.multipliers = parent.multipliers;
        child.decisions = parent.decisions;
        child.decisions.push_back({branching, in});
        child.bound = parent.bound;
        child.max_steps = branching.on == Branching::On::end && !in
                              ? options_.tuning.branching.steps_without_end
                              : options_.node_steps;
    }
}

double BranchAndBound::run_root() {
    restart();
    ascend_root();
    return root_.bound;
}

std::vector<Multipliers> BranchAndBound::run_root_in_stages(double unit) {
    MultiplierStages stages(unit);
    restart(&stages);
    ascend_root();
    if (root_.bound > -kUnreachable) stages.add(root_multipliers());
    return stages.take();
}

void BranchAndBound::restart(MultiplierStages* stages) {
    cliques_.clear();
    decisions_.reset(graph_);
    second_leg_.reset();
    ascent_.restart(stages);
    starting_ = system_.kinds[0].start;
    for (std::size_t cone = 0; cone < starting_.size(); ++cone) {
        if (system_.kind_count == 2 && system_.kinds[1].start[cone] != 0) starting_[cone] = 1;
    }
    root_.graph.assign(graph_, starting_, clock_);
    root_.restart(graph_, 0);
    improver_.restart();
    queue_.clear();
}

}  // namespace conelane::path_pair
