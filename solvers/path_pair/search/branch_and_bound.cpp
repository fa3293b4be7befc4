#include "solvers/path_pair/search/branch_and_bound.hpp"

#include "solvers/path_pair/graph/to_index.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <utility>

namespace conelane::path_pair {
namespace {

constexpr double kMemory = 0.9;  ///< of the averaged edge use, per step
constexpr int kMaxCliques = 600;
constexpr int kCliquesPerRound = 12;
constexpr int kStepsPerRound = 4;
constexpr double kMinEndDoubt = 0.1;
constexpr double kMinGain = 0.005;  ///< of the gap, for a step to count as progress
constexpr int kPatience = 4;        ///< steps without progress
constexpr double kMinScale = 0.1;
constexpr int kRootPatience = 8;
constexpr double kRootLeastScale = 0.2;
constexpr double kWorthwhile = 0.6;        ///< of the gap at which the fronts were too many, to try again
constexpr std::int64_t kFewFronts = 1000;  ///< of the first tries
constexpr std::int64_t kFirstFrontsOfSmallGraph = 2000;
constexpr int kSmallGraph = 200;                     ///< arcs
constexpr std::int64_t kWorkPerFront = 30;           ///< label updates of the ascent that allow one front
constexpr std::size_t kMaxFronts = 300000;           ///< of the last try, before a node branches
constexpr std::size_t kMaxFrontBytes = 200'000'000;  ///< of their tables, together
constexpr std::size_t kMaxWindowFronts = 3000;
constexpr std::size_t kWorkPerMadeFront = 500;  ///< of the clock
constexpr std::size_t kMaxLabels = 1000000;
constexpr std::size_t kMaxLabelWords = 40'000'000;  ///< of their sets of edges, together
constexpr int kWideFronts = 4000;   ///< from here on first a narrow search, for the incumbent, and detours
constexpr std::size_t kNarrow = 2;  ///< labels a front
constexpr std::size_t kFirstBeamWidth = 2;  ///< before the first try
constexpr int kFirstBeamArcs = 70;
constexpr int kBeams = 2;
constexpr int kBeamSteps[kBeams] = {20, 60};  ///< of the root's ascent, or later
constexpr std::size_t kBeamWidth = 8;
constexpr double kTargets[] = {0.3, 0.6, 1.0};  ///< shares of the gap
constexpr double kLowerTargets[] = {0.3, 0.1};  ///< shares of a target's gap that was too wide
constexpr double kMinTargetGap = 1.0;
constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();
constexpr int kFirstImprovement = 2;   ///< step of the root's ascent
constexpr int kLateAscent = 1000;      ///< arcs from which on it is before the first step
constexpr double kMaxOvershoot = 2.0;  ///< of the ascent's steps
constexpr int kRestSteps = 2;
constexpr std::size_t kMaxOpenNodes = 2000;
constexpr std::int64_t kTries = 60;         ///< arcs tried around a walk for a better incumbent
constexpr std::int64_t kFirstTries = 1000;  ///< and for the first one

}  // namespace

BranchAndBound::BranchAndBound(const ArcGraph& graph, Incumbent& incumbent, const PathPairOptions& options)
    : graph_(graph), incumbent_(incumbent), options_(options) {}

BranchAndBound::Outcome BranchAndBound::run(const LegSystem& system, double tolerance, SearchClock& clock) {
    begin(system, tolerance, clock);
    root_.bound = graph_.share_bound();
    root_.max_steps = options_.root_steps;
    ++nodes_;
    double open_bound = kUnreachable;
    if (explore(root_) == Verdict::stopped) open_bound = root_.bound;
    while (open_bound == kUnreachable && !open_.empty()) {
        std::unique_ptr<Node> next = take_next();
        improve_incumbent(root_.graph, next->bound);
        if (next->bound < cutoff()) {
            ++nodes_;
            if (explore(*next) == Verdict::stopped) open_bound = std::min(next->bound, min_open_bound());
        }
        spare_nodes_.push_back(std::move(next));
    }
    return {std::min(open_bound, cutoff()), open_bound == kUnreachable};
}

double BranchAndBound::run_root(const LegSystem& system, double tolerance, SearchClock& clock) {
    begin(system, tolerance, clock);
    root_.max_steps = options_.root_steps;
    ascend(root_, true);
    return root_.bound;
}

std::vector<Multipliers> BranchAndBound::run_root_in_stages(const LegSystem& system, double unit,
                                                            SearchClock& clock) {
    unit_ = unit;
    stages_.clear();
    begin(system, 0.0, clock);
    root_.max_steps = options_.root_steps;
    ascend(root_, true);
    unit_ = 0.0;
    if (root_.bound > -kUnreachable) stages_.push_back(root_multipliers());
    return std::move(stages_);
}

void BranchAndBound::begin(const LegSystem& system, double tolerance, SearchClock& clock) {
    tolerance_ = tolerance;
    clock_ = &clock;
    cliques_.clear();
    decisions_.reset(graph_);
    relaxation_.bind(graph_, system, cliques_, decisions_, clock);
    second_leg_.reset(graph_, clock);
    completion_.bind(graph_, relaxation_, incumbent_, second_leg_, clock);
    fronts_.bind(relaxation_, clock);
    frontier_search_.bind(graph_, relaxation_, incumbent_, clock);
    beam_.bind(graph_, relaxation_, incumbent_, clock);
    edge_use_.assign(to_index(graph_.edge_count()), 0.0);
    end_use_.assign(to_index(graph_.cone_count()), 0.0);
    index_.assign(to_index(graph_.cone_count()), 0);
    starting_ = system.kinds[0].start;
    for (std::size_t cone = 0; cone < starting_.size(); ++cone) {
        if (system.kind_count == 2 && system.kinds[1].start[cone] != 0) starting_[cone] = 1;
    }
    root_.graph.assign(graph_, starting_, clock);
    whole_system_ = &system;
    begin_improvement();
    root_.multipliers.cone.assign(to_index(graph_.cone_count()), 0.0);
    root_.multipliers.clique.clear();
    root_.multipliers.heading = 0.0;
    root_.bound = -kUnreachable;
    std::ranges::move(open_, std::back_inserter(spare_nodes_));
    open_.clear();
    // The same search takes the same nodes again, whose memory has the right size.
    std::ranges::sort(spare_nodes_, std::greater(), [](const auto& node) { return node->number; });
}

/// Bounds and searches the node, and branches where that leaves it open.
BranchAndBound::Verdict BranchAndBound::explore(Node& node) {
    take_decisions(node);
    const Verdict verdict = ascend(node, &node == &root_);
    if (verdict == Verdict::open) add_children(node);
    return verdict;
}

/// On an end: first all pairs that have it, then the rest, from the same multipliers.
void BranchAndBound::add_children(const Node& parent) {
    const Branching branching = choose(parent.graph);
    const bool on_end = branching.on == Branching::On::end;
    const bool in_first = on_end || branching.use >= 0.4;
    for (const bool in : {!in_first, in_first}) {  // the last one comes next
        Node& child = add_open_node();
        branch(parent.graph, branching, in, child.graph);
        child.multipliers = parent.multipliers;
        child.decisions = parent.decisions;
        child.decisions.push_back({branching, in});
        child.bound = parent.bound;
        child.max_steps = on_end && !in ? kRestSteps : options_.node_steps;
    }
}

BranchAndBound::Node& BranchAndBound::add_open_node() {
    if (spare_nodes_.empty()) {
        spare_nodes_.push_back(std::make_unique<Node>());
        spare_nodes_.back()->number = nodes_made_++;
    }
    open_.push_back(std::move(spare_nodes_.back()));
    spare_nodes_.pop_back();
    return *open_.back();
}

std::unique_ptr<BranchAndBound::Node> BranchAndBound::take_next() {
    auto next = open_.end() - 1;
    if (open_.size() < kMaxOpenNodes) {  // else depth-first, which bounds the memory
        for (auto node = open_.end(); node-- != open_.begin();) {
            if ((*node)->bound < (*next)->bound) next = node;
        }
    }
    std::unique_ptr<Node> taken = std::move(*next);
    open_.erase(next);
    return taken;
}

void BranchAndBound::take_decisions(const Node& node) {
    decisions_.reset(graph_);
    for (const auto& [branching, in] : node.decisions) {
        if (branching.on == Branching::On::end) {
            decisions_.decide_end(branching.what, in ? Decisions::End::always : Decisions::End::never);
        } else if (in) {
            decisions_.require_edge(graph_, branching.what, true);
        }
    }
}

double BranchAndBound::min_open_bound() const {
    double least = kUnreachable;
    for (const std::unique_ptr<Node>& node : open_) least = std::min(least, node->bound);
    return least;
}

BranchAndBound::Verdict BranchAndBound::ascend(Node& here, bool is_root) {
    begin_ascent(here);
    AscentState state;
    state.is_root = is_root;
    if (is_root && here.graph.size() >= kFirstBeamArcs && here.graph.size() < kLateAscent) {
        state.first_try = 0;
    }
    for (;; ++state.step) {
        if (is_root && (state.step >= kFirstImprovement || graph_.arc_count() >= kLateAscent)) {
            improve_incumbent(here.graph, here.bound);
        }
        if (clock_->out_of_time()) return Verdict::stopped;
        state.value = evaluate(here.graph);
        if (state.value == -kUnreachable) return Verdict::stopped;
        note_value(here, state);
        here.bound = std::max(here.bound, state.value);
        if (state.value >= cutoff()) return Verdict::closed;
        relaxation_.evaluate_backward(here.graph);
        if (clock_->struck()) return Verdict::stopped;
        count_usage(here.graph);
        if (options_.complete_walks && state.step == state.next_completion) complete_walks(here.graph, state);
        if (state.value >= cutoff()) return Verdict::closed;
        state.last =
            state.step + 1 >= here.max_steps || state.scale < (state.is_root ? kRootLeastScale : kMinScale);
        if (state.last) {
            take_best_multipliers(here);
            if (relaxation_.evaluate(here.graph, multipliers_) == -kUnreachable) return Verdict::stopped;
        }
        if (options_.search_frontiers) {
            const Verdict verdict = try_frontiers(here.graph, state);
            here.bound = std::max(here.bound, state.best);
            if (verdict != Verdict::open) return verdict;
        }
        if (state.last) break;
        move_multipliers(here, state);
        if (options_.fix_arcs && fix(here) && here.graph.arc.empty()) return Verdict::closed;
        if (options_.clique_multipliers && !in_window_ && state.step % kStepsPerRound == kStepsPerRound - 1) {
            separate(here.graph, multipliers_);
        }
    }
    if (in_window_) return Verdict::open;
    // With every edge decided nothing is left to branch on: one pair of paths at most.
    if (choose(here.graph).on != Branching::On::nothing) return Verdict::open;
    return search_frontiers(here.graph, {kAny, kAny});
}

double BranchAndBound::evaluate(const ResidualGraph& graph) {
    const double value = relaxation_.evaluate(graph, multipliers_);
    if (unit_ == 0.0 || value == -kUnreachable) return value;
    // Upwards, and that of the heading downwards: no arc gets cheaper, so no cycle gains.
    for (double& multiplier : multipliers_.cone) multiplier = unit_ * std::ceil(multiplier / unit_);
    for (double& multiplier : multipliers_.clique) multiplier = unit_ * std::ceil(multiplier / unit_);
    multipliers_.heading = unit_ * std::floor(multipliers_.heading / unit_);
    evaluated_ = multipliers_;
    return relaxation_.evaluate(graph, multipliers_);
}

void BranchAndBound::take_best_multipliers(const Node& here) {
    multipliers_ = here.multipliers;
    multipliers_.clique.resize(to_index(cliques_.size()), 0.0);
}

void BranchAndBound::begin_ascent(const Node& here) {
    take_best_multipliers(here);
    // Only a required cone's multiplier may be negative.
    for (std::size_t v = 0; v < multipliers_.cone.size(); ++v) {
        if (decisions_.visited()[v] == 0) multipliers_.cone[v] = std::max(0.0, multipliers_.cone[v]);
    }
    ascent_.restart(multipliers_);
}

void BranchAndBound::note_value(Node& here, AscentState& state) {
    state.work += here.graph.size() + static_cast<int>(here.graph.out_arc.size());
    if (state.value > state.best + kMinGain * std::abs(incumbent_.cutoff() - state.best)) {
        state.since_best = 0;
    } else {
        ++state.since_best;
    }
    if (state.value > state.best) {
        state.best = state.value;
        here.multipliers = multipliers_;
    }
}

void BranchAndBound::complete_walks(const ResidualGraph& graph, AscentState& state) {
    const double before = incumbent_.cutoff();
    const std::array<std::vector<int>, 2>& walks = relaxation_.walks(graph);
    for (int leg = 0; leg < 2; ++leg) {
        completion_.complete(graph, relaxation_.symmetric() ? 0 : leg, walks[to_index(leg)], tolerance_,
                             incumbent_.found() ? kTries : kFirstTries);
    }
    const int wait = !incumbent_.found() ? 1 : incumbent_.cutoff() < before ? 2 : 4 + state.step / 2;
    state.next_completion = state.step + wait;
}

BranchAndBound::Verdict BranchAndBound::try_frontiers(const ResidualGraph& graph, AscentState& state) {
    const bool due = state.step == state.first_try || state.step % 4 == 3;
    const bool promising = due && cutoff() - state.value < kWorthwhile * state.failed_gap;
    if (!state.last && !promising) return Verdict::open;
    const bool is_small = state.step == 0 && graph.size() < kSmallGraph;
    const auto max_fronts = static_cast<std::size_t>(
        std::max(is_small ? kFirstFrontsOfSmallGraph : kFewFronts, state.work / kWorkPerFront));
    const Verdict verdict =
        state.last ? search_frontiers_by_target(graph, state)
                   : search_frontiers(graph, {max_fronts, kMaxLabels, state.step == 0 ? kFirstBeamWidth : 0});
    if (verdict == Verdict::open) {
        if (state.is_root && !state.last && state.beams < kBeams && state.step >= kBeamSteps[state.beams]) {
            ++state.beams;
            beam_.run(graph, edge_sets_, tolerance_, kBeamWidth);
        }
        state.failed_gap = cutoff() - state.value;
        state.work = 0;
    }
    return verdict;
}

void BranchAndBound::move_multipliers(const Node& here, AscentState& state) {
    if (state.since_best < (state.is_root ? kRootPatience : kPatience)) {
        ascent_.step(multipliers_, usage_, decisions_.visited(), step_gap(state), state.scale);
        return;
    }
    // The steps were too long: shorter ones, from the best multipliers.
    state.since_best = 0;
    state.scale *= 0.5;
    take_best_multipliers(here);
    ascent_.restart(multipliers_);
}

/// Up to the incumbent; at the root up to the last one that the ascent found, which is farther away than one
/// from windows. With steps up to that one it takes nearly twice as many.
double BranchAndBound::step_gap(const AscentState& state) const {
    const double gap = incumbent_.cutoff() - state.value;
    if (!state.is_root || incumbent_.cutoff() < improvement_.known_cost) return gap;
    return std::clamp(improvement_.outside_cost - state.value, gap, kMaxOvershoot * gap);
}

/// Searches for pairs below targets between the bound and the incumbent first. Fronts and labels are far
/// fewer below a lower target; a pair that is found there is the best one, and where there is none the target
/// is a bound. Where they are too many, a still lower target raises the bound that the node leaves open.
BranchAndBound::Verdict BranchAndBound::search_frontiers_by_target(const ResidualGraph& graph,
                                                                   AscentState& state) {
    const double incumbent = incumbent_.cutoff();
    for (const double share : kTargets) {
        const double target = state.best + share * (incumbent - state.best);
        if (share < 1.0 && incumbent - target < kMinTargetGap) continue;
        Verdict verdict = search_below(graph, target, state);
        for (const double part : kLowerTargets) {
            const double step = part * (target - state.best);
            if (verdict != Verdict::open || in_window_ || incumbent_.cutoff() < target ||
                step < kMinTargetGap)
                break;
            if (search_below(graph, state.best + step, state) == Verdict::closed) break;
        }
        if (incumbent_.cutoff() < target || verdict != Verdict::closed) return verdict;
    }
    return Verdict::closed;
}

/// All pairs of the node that cost less than the target, which is not above the incumbent. Where there is
/// none the target is the node's bound; a pair that is found is the incumbent from then on.
BranchAndBound::Verdict BranchAndBound::search_below(const ResidualGraph& graph, double target,
                                                     AscentState& state) {
    const double incumbent = incumbent_.cutoff();
    incumbent_.set_cutoff(target);
    const Verdict verdict = search_frontiers(graph, {in_window_ ? kMaxWindowFronts : kMaxFronts, kMaxLabels});
    if (incumbent_.cutoff() < target) return verdict;
    incumbent_.set_cutoff(incumbent);
    if (verdict == Verdict::closed) state.best = std::max(state.best, target - tolerance_);
    return verdict;
}

BranchAndBound::Verdict BranchAndBound::build_frontiers(const ResidualGraph& graph,
                                                        const FrontierLimits& limits) {
    const auto limit = [&] { return cutoff() + relaxation_.offset(); };
    edge_sets_.assign(graph_, graph, *clock_);
    if (limits.beam_width > 0) beam_.run(graph, edge_sets_, tolerance_, limits.beam_width);
    if (clock_->struck()) return Verdict::stopped;
    dominated_edges_.find(graph, relaxation_, edge_sets_, options_.drop_dominated_edges, *clock_);
    if (clock_->struck()) return Verdict::stopped;
    const bool built = fronts_.build(graph, dominated_edges_, limit(), limits.fronts,
                                     options_.drop_dominated_edges ? &edge_sets_ : nullptr);
    clock_->out_of_time(kWorkPerMadeFront * to_index(fronts_.size()));
    if (!built) {
        return clock_->out_of_time() ? Verdict::stopped : Verdict::open;
    }
    double bound = fronts_.find_onward(limit());
    if (options_.drop_dominated_edges && bound < limit()) {
        fronts_.drop(limit());
        fronts_.drop_dominated_edges(edge_sets_);
        fronts_.find_forward();
        bound = fronts_.find_onward(limit());
    }
    if (clock_->out_of_time()) return Verdict::stopped;
    if (!(bound < limit())) return Verdict::closed;
    fronts_.drop(limit());
    frontiers_are_built_ = true;
    return Verdict::open;
}

void BranchAndBound::find_tables() {
    onward_tables_.find(fronts_, edge_sets_, cutoff() + relaxation_.offset(), fronts_.size() >= kWideFronts,
                        *clock_);
}

BranchAndBound::Verdict BranchAndBound::search_frontiers(const ResidualGraph& graph,
                                                         const FrontierLimits& limits) {
    frontiers_are_built_ = false;
    const Verdict built = build_frontiers(graph, limits);
    if (!frontiers_are_built_) return built;
    if (limits.fronts != kAny && to_index(fronts_.size()) > kMaxFrontBytes / OnwardTables::row_bytes(graph)) {
        return Verdict::open;
    }
    std::size_t max_labels = limits.labels;
    if (max_labels != kAny) {
        max_labels = std::min(max_labels, kMaxLabelWords / std::max<std::size_t>(1, edge_sets_.words()));
    }
    find_tables();
    for (const std::size_t width : {kNarrow, FrontierSearch::kAnyWidth}) {
        if (clock_->out_of_time()) return Verdict::stopped;
        if (width == kNarrow && fronts_.size() < kWideFronts) continue;
        const double before = incumbent_.cutoff();
        const FrontierSearch::Outcome outcome =
            frontier_search_.run(fronts_, edge_sets_, onward_tables_, {tolerance_, width, max_labels});
        if (outcome == FrontierSearch::Outcome::exhausted) return Verdict::closed;
        if (outcome == FrontierSearch::Outcome::stopped) break;
        if (incumbent_.cutoff() < before) {
            fronts_.drop(cutoff() + relaxation_.offset());
            find_tables();
        }
    }
    return clock_->out_of_time() ? Verdict::stopped : Verdict::open;
}

void BranchAndBound::count_usage(const ResidualGraph& graph) {
    usage_.cone.assign(to_index(graph_.cone_count()), 0);
    usage_.clique.assign(to_index(cliques_.size()), 0);
    usage_.along_heading = 0;
    for (double& use : edge_use_) use *= kMemory;
    for (double& use : end_use_) use *= kMemory;
    for (const int end : relaxation_.ends()) {
        if (end >= 0) end_use_[to_index(end)] += 1.0 - kMemory;
    }
    index_.assign(to_index(graph_.edge_count()), 0);
    for (const std::vector<int>& walk : relaxation_.walks(graph)) {
        if (walk.empty()) continue;
        ++usage_.cone[to_index(graph.tail[to_index(walk.front())])];
        for (const int a : walk) {
            ++usage_.cone[to_index(graph.head[to_index(a)])];
            edge_use_[to_index(graph.edge(a))] += 1.0 - kMemory;
            ++index_[to_index(graph.edge(a))];
            usage_.along_heading += graph_.along_heading(graph.edge(a)) ? 1 : 0;
        }
    }
    for (int q = 0; q < cliques_.size(); ++q) {
        for (const int edge : cliques_.edges(q)) usage_.clique[to_index(q)] += index_[to_index(edge)];
    }
}

void BranchAndBound::separate(const ResidualGraph& graph, Multipliers& multipliers) {
    if (cliques_.size() >= kMaxCliques) return;
    edge_alive_.assign(to_index(graph_.edge_count()), 0);
    for (int a = 0; a < graph.size(); ++a) edge_alive_[to_index(graph.edge(a))] = 1;
    separation_.separate(graph_, edge_use_, edge_alive_, kCliquesPerRound, cliques_, *clock_);
    multipliers.clique.resize(to_index(cliques_.size()), 0.0);
}

/// Drops what cannot be in a better pair. False, and nothing dropped, where renumbering is not worth it.
bool BranchAndBound::fix(Node& here) {
    const ResidualGraph& graph = here.graph;
    const double limit = cutoff() + relaxation_.offset();
    keep_successor_.assign(graph.out_arc.size(), 0);
    order_.clear();
    std::size_t kept = 0;
    for (int a = 0; a < graph.size(); ++a) {
        bool alive = false;
        for (int kind = 0; kind < relaxation_.system().kind_count; ++kind) {
            const std::span<const double> forward = relaxation_.forward(kind);
            const std::span<const double> backward = relaxation_.backward(kind);
            if (!(forward[to_index(a)] + backward[to_index(a)] < limit)) continue;
            alive = true;
            for (int position = graph.out_start[to_index(a)]; position < graph.out_start[to_index(a) + 1];
                 ++position) {
                const std::size_t next = to_index(graph.out_arc[to_index(position)]);
                if (keep_successor_[to_index(position)] != 0) continue;
                const double through = forward[to_index(a)] + graph.out_cost[to_index(position)] +
                                       relaxation_.reduced()[next] + backward[next];
                if (!(through < limit)) continue;
                keep_successor_[to_index(position)] = 1;
                ++kept;
            }
        }
        if (alive) order_.push_back(a);
    }
    if (10 * (order_.size() + kept) > 9 * (graph.arc.size() + graph.out_arc.size())) return false;
    spare_.filter(graph, order_, keep_successor_, index_);
    here.graph = spare_;  // no swap: a node keeps its memory from search to search
    if (unit_ > 0.0) stages_.push_back(evaluated_);
    return true;
}

void BranchAndBound::branch(const ResidualGraph& source, const Branching& branching, bool in,
                            ResidualGraph& target) {
    order_.clear();
    keep_successor_.assign(source.out_arc.size(), 1);
    if (branching.on == Branching::On::end) {
        for (int a = 0; a < source.size(); ++a) {
            if (!in || source.tail[to_index(a)] != branching.what) order_.push_back(a);
        }
        target.filter(source, order_, keep_successor_, index_);
        return;
    }
    const int edge = branching.what;
    const int ends[2] = {graph_.tail(2 * edge), graph_.head(2 * edge)};
    for (int a = 0; a < source.size(); ++a) {
        const int other = source.edge(a);
        if (!(in ? graph_.incompatible(edge, other) : other == edge)) order_.push_back(a);
    }
    if (in) {
        for (int a = 0; a < source.size(); ++a) {
            const int cone = source.head[to_index(a)];
            if ((cone != ends[0] && cone != ends[1]) || source.edge(a) == edge) continue;
            for (int p = source.out_start[to_index(a)]; p < source.out_start[to_index(a) + 1]; ++p) {
                if (source.edge(source.out_arc[to_index(p)]) != edge) keep_successor_[to_index(p)] = 0;
            }
        }
    }
    target.filter(source, order_, keep_successor_, index_);
}

BranchAndBound::Branching BranchAndBound::choose(const ResidualGraph& graph) const {
    Branching best{Branching::On::nothing, -1, 0.0};
    double best_score = -1.0;
    const auto doubt = [](double use) { return std::min(use, std::max(0.0, 1.0 - use)); };
    if (relaxation_.symmetric()) {
        for (const int cone : relaxation_.ends()) {
            if (cone < 0 || decisions_.end(cone) != Decisions::End::open) continue;
            const double use = end_use_[to_index(cone)];
            if (use >= 1.0 - kMinEndDoubt || use <= best_score) continue;
            best = {Branching::On::end, cone, use};
            best_score = use;
        }
        if (best.on != Branching::On::nothing) return best;
    }
    best_score = -1.0;
    for (int a = 0; a < graph.size(); ++a) {
        const int edge = graph.edge(a);
        const double use = edge_use_[to_index(edge)];
        if (decisions_.edge_required(edge) || doubt(use) <= best_score) continue;
        best = {Branching::On::edge, edge, use};
        best_score = doubt(use);
    }
    return best;
}

}  // namespace conelane::path_pair
