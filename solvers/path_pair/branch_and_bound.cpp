#include "solvers/path_pair/branch_and_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace conelane::path_pair {
namespace {

constexpr double kMemory = 0.9;  ///< of the averaged edge use, per step
constexpr int kMostCliques = 600;
constexpr int kCliquesPerRound = 12;
constexpr int kStepsPerRound = 4;
constexpr double kLeastEndDoubt = 0.1;
constexpr double kLeastGain = 0.005;  ///< of the gap, for a step to count as progress
constexpr int kPatience = 4;          ///< steps without progress
constexpr double kLeastScale = 0.1;
constexpr double kWorthwhile = 0.8;        ///< of the gap at which the fronts were too many, to try again
constexpr std::int64_t kFewFronts = 2000;  ///< of the first try
constexpr std::int64_t kWorkPerFront =
    30;  ///< label updates of the ascent that a front may take the place of
constexpr std::size_t kMostFronts = 100000;         ///< before a node branches
constexpr std::size_t kMostFrontWords = 4'000'000;  ///< of their sets of edges, together
constexpr std::size_t kMostLabels = 500000;
constexpr std::size_t kMostLabelWords = 40'000'000;  ///< of their sets of edges, together
constexpr int kWideFronts = 500;    ///< from here on first a narrow search, for the incumbent
constexpr std::size_t kNarrow = 2;  ///< labels a front
constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();
constexpr int kLargeGraph = 250;  ///< arcs
constexpr int kNearArcs = 100;
constexpr int kRestSteps = 2;
constexpr std::int64_t kTries = 60;         ///< arcs tried around a walk for a better incumbent
constexpr std::int64_t kFirstTries = 1000;  ///< and for the first one
constexpr double kStepScale = 1.0;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

}  // namespace

BranchAndBound::BranchAndBound(const ArcGraph& graph, Incumbent& incumbent, const PathPairOptions& options)
    : graph_(graph), incumbent_(incumbent), options_(options) {}

BranchAndBound::Node& BranchAndBound::node(std::size_t depth) {
    while (nodes_by_depth_.size() <= depth) nodes_by_depth_.push_back(std::make_unique<Node>());
    return *nodes_by_depth_[depth];
}

BranchAndBound::Outcome BranchAndBound::run(const LegSystem& system, double tolerance,
                                            std::function<bool()> stopped) {
    begin(system, tolerance, std::move(stopped));
    if (options_.search_fronts) begin_near();
    explore(0, graph_.share_bound(), options_.root_steps);
    return {std::min(open_bound_, cutoff()), open_bound_ == kUnreachable};
}

double BranchAndBound::run_root(const LegSystem& system, double tolerance, std::function<bool()> stopped) {
    begin(system, tolerance, std::move(stopped));
    double bound = -kUnreachable;
    ascend(0, bound, options_.root_steps);
    return bound;
}

void BranchAndBound::begin(const LegSystem& system, double tolerance, std::function<bool()> stopped) {
    tolerance_ = tolerance;
    clock_ = SearchClock(std::move(stopped));
    stopped_ = [this] { return clock_.out_of_time(); };
    cliques_.clear();
    decisions_.reset(graph_);
    relaxation_.bind(graph_, system, cliques_, decisions_, clock_);
    completion_.bind(graph_, relaxation_, incumbent_, clock_);
    fronts_.bind(relaxation_, stopped_);
    front_search_.bind(graph_, relaxation_, incumbent_);
    edge_use_.assign(at(graph_.edge_count()), 0.0);
    end_use_.assign(at(graph_.cone_count()), 0.0);
    index_.assign(at(graph_.cone_count()), 0);
    std::vector<char> starting = system.kinds[0].start;
    for (std::size_t cone = 0; cone < starting.size(); ++cone) {
        if (system.kind_count == 2 && system.kinds[1].start[cone] != 0) starting[cone] = 1;
    }
    Node& root = node(0);
    root.graph.assign(graph_, starting);
    root.prices.cone.assign(at(graph_.cone_count()), 0.0);
    root.prices.clique.clear();
    root.prices.heading = 0.0;
    open_bound_ = kUnreachable;
}

/// In a large graph first the arcs that a leg reaches first: their best pair is one of the whole.
void BranchAndBound::begin_near() {
    const ResidualGraph& whole = node(0).graph;
    if (whole.size() < kLargeGraph) return;
    order_.resize(at(kNearArcs));
    std::iota(order_.begin(), order_.end(), 0);
    keep_out_.assign(whole.out_arc.size(), 1);
    Node& near = node(1);
    near.graph.filter(whole, order_, keep_out_, index_);
    near.prices = node(0).prices;
    double bound = -kUnreachable;
    ascend(1, bound, options_.node_steps);
    std::ranges::fill(edge_use_, 0.0);
    std::ranges::fill(end_use_, 0.0);
}

void BranchAndBound::explore(std::size_t depth, double bound, int most_steps) {
    ++nodes_;
    const Verdict verdict = ascend(depth, bound, most_steps);
    if (verdict == Verdict::closed) return;
    if (verdict == Verdict::stopped) {
        open_bound_ = std::min(open_bound_, bound);
        return;
    }
    const Branching branching = choose(node(depth).graph);
    // An end: first all pairs that have it, then the rest, bounded by the same prices until its turn comes.
    const bool on_end = branching.on == Branching::On::end;
    const bool in_first = on_end || branching.use >= 0.4;
    for (const bool in : {in_first, !in_first}) {
        Node& child = node(depth + 1);
        branch(node(depth).graph, branching, in, child.graph);
        child.prices = node(depth).prices;
        decide(branching, in, false);
        explore(depth + 1, bound, on_end && !in ? kRestSteps : options_.node_steps);
        decide(branching, in, true);
        if (open_bound_ < kUnreachable) {  // stopped: what is not yet explored is no better bounded than here
            open_bound_ = std::min(open_bound_, bound);
            return;
        }
        if (bound >= cutoff()) return;
    }
}

BranchAndBound::Verdict BranchAndBound::ascend(std::size_t depth, double& bound, int most_steps) {
    Node& here = node(depth);
    prices_ = here.prices;
    prices_.clique.resize(at(cliques_.size()), 0.0);
    // A required cone's price has no sign, others' have one.
    for (std::size_t v = 0; v < prices_.cone.size(); ++v) {
        if (decisions_.visited()[v] == 0) prices_.cone[v] = std::max(0.0, prices_.cone[v]);
    }
    ascent_.restart(prices_);
    double best = -kUnreachable;
    double scale = kStepScale;
    int since_best = 0;
    int next_try = 0;
    // The root looks for an incumbent of its own, whatever its near part found.
    const double first_cutoff = depth == 0 ? incumbent_.cutoff() : kUnreachable;
    const auto has_incumbent = [&] { return incumbent_.found() && incumbent_.cutoff() < first_cutoff; };
    std::int64_t work = 0;             // label updates, about
    double failed_gap = kUnreachable;  // at which the fronts were too many
    for (int step = 0;; ++step) {
        if (stopped_()) return Verdict::stopped;
        const double value = relaxation_.evaluate(here.graph, prices_);
        if (value == -kUnreachable) return Verdict::stopped;
        work += here.graph.size() + static_cast<int>(here.graph.out_arc.size());
        if (value > best + kLeastGain * std::abs(incumbent_.cutoff() - best)) {
            since_best = 0;
        } else {
            ++since_best;
        }
        if (value > best) {
            best = value;
            here.prices = prices_;
        }
        bound = std::max(bound, value);
        if (value >= cutoff()) return Verdict::closed;
        relaxation_.evaluate_backward(here.graph);
        if (clock_.struck()) return Verdict::stopped;
        count_usage(here.graph);
        if (options_.complete_walks) {
            if (step == next_try) {
                const double before = incumbent_.cutoff();
                const std::array<std::vector<int>, 2>& walks = relaxation_.walks(here.graph);
                for (int leg = 0; leg < 2; ++leg) {
                    completion_.complete(here.graph, relaxation_.symmetric() ? 0 : leg, walks[at(leg)],
                                         tolerance_, has_incumbent() ? kTries : kFirstTries);
                }
                next_try = step + (!has_incumbent() ? 1 : incumbent_.cutoff() < before ? 2 : 4 + step / 2);
            }
        }
        if (value >= cutoff()) return Verdict::closed;
        const bool last = step + 1 >= most_steps || scale < kLeastScale;
        if (last) {
            prices_ = here.prices;
            prices_.clique.resize(at(cliques_.size()), 0.0);
            if (relaxation_.evaluate(here.graph, prices_) == -kUnreachable) return Verdict::stopped;
        }
        if (options_.search_fronts && (step == 1 || step % 4 == 3 || last) &&
            (last || cutoff() - value < kWorthwhile * failed_gap)) {
            const std::size_t most_fronts =
                last ? kMostFronts : static_cast<std::size_t>(std::max(kFewFronts, work / kWorkPerFront));
            const Verdict verdict = search_fronts(here.graph, most_fronts, kMostLabels);
            if (verdict != Verdict::open) return verdict;
            failed_gap = cutoff() - value;
            work = 0;
        }
        if (last) break;
        if (since_best >= kPatience) {
            // Too far: from the best prices again, in shorter steps.
            since_best = 0;
            scale *= 0.5;
            prices_ = here.prices;
            prices_.clique.resize(at(cliques_.size()), 0.0);
            ascent_.restart(prices_);
        } else {
            ascent_.step(prices_, usage_, decisions_.visited(), incumbent_.cutoff() - value, scale);
        }
        if (options_.fix_arcs && fix(here) && here.graph.arc.empty()) return Verdict::closed;
        if (options_.clique_prices && step % kStepsPerRound == kStepsPerRound - 1) {
            separate(here.graph, prices_);
        }
    }
    // With every edge decided nothing is left to branch on: one pair of paths at most.
    if (choose(here.graph).on != Branching::On::nothing) return Verdict::open;
    return search_fronts(here.graph, kAny, kAny);
}

BranchAndBound::Verdict BranchAndBound::search_fronts(const ResidualGraph& graph, std::size_t most_fronts,
                                                      std::size_t most_labels) {
    const auto limit = [&] { return cutoff() + relaxation_.offset(); };
    edge_sets_.assign(graph_, graph, clock_);
    if (clock_.struck()) return Verdict::stopped;
    sure_losses_.find(graph, relaxation_, edge_sets_, options_.drop_sure_losses, clock_);
    if (clock_.struck()) return Verdict::stopped;
    if (most_fronts != kAny) {
        most_fronts = std::min(most_fronts, kMostFrontWords / std::max<std::size_t>(1, edge_sets_.words()));
    }
    if (!fronts_.build(graph, sure_losses_, limit(), most_fronts)) {
        return stopped_() ? Verdict::stopped : Verdict::open;
    }
    double bound = fronts_.find_onward(limit());
    if (options_.drop_sure_losses && bound < limit()) {
        fronts_.drop(limit());
        fronts_.drop_sure_losses(edge_sets_);
        fronts_.find_forward();
        bound = fronts_.find_onward(limit());
    }
    if (stopped_()) return Verdict::stopped;
    if (!(bound < limit())) return Verdict::closed;
    fronts_.drop(limit());
    const std::size_t label_limit =
        most_labels == kAny
            ? kAny
            : std::min(most_labels, kMostLabelWords / std::max<std::size_t>(1, edge_sets_.words()));
    for (const std::size_t width : {kNarrow, FrontSearch::kAnyWidth}) {
        if (stopped_()) return Verdict::stopped;
        if (width == kNarrow && fronts_.size() < kWideFronts) continue;
        const double before = incumbent_.cutoff();
        const FrontSearch::Outcome outcome =
            front_search_.run(fronts_, edge_sets_, {tolerance_, width, label_limit}, stopped_);
        if (outcome == FrontSearch::Outcome::exhausted) return Verdict::closed;
        if (outcome == FrontSearch::Outcome::stopped) break;
        if (incumbent_.cutoff() < before) fronts_.drop(limit());
    }
    return stopped_() ? Verdict::stopped : Verdict::open;
}

void BranchAndBound::count_usage(const ResidualGraph& graph) {
    usage_.cone.assign(at(graph_.cone_count()), 0);
    usage_.clique.assign(at(cliques_.size()), 0);
    usage_.along_heading = 0;
    for (double& use : edge_use_) use *= kMemory;
    for (double& use : end_use_) use *= kMemory;
    for (const int end : relaxation_.ends()) {
        if (end >= 0) end_use_[at(end)] += 1.0 - kMemory;
    }
    index_.assign(at(graph_.edge_count()), 0);
    for (const std::vector<int>& walk : relaxation_.walks(graph)) {
        if (walk.empty()) continue;
        ++usage_.cone[at(graph.tail[at(walk.front())])];
        for (const int a : walk) {
            ++usage_.cone[at(graph.head[at(a)])];
            edge_use_[at(graph.edge(a))] += 1.0 - kMemory;
            ++index_[at(graph.edge(a))];
            usage_.along_heading += graph_.along_heading(graph.edge(a)) ? 1 : 0;
        }
    }
    for (int q = 0; q < cliques_.size(); ++q) {
        for (const int edge : cliques_.edges(q)) usage_.clique[at(q)] += index_[at(edge)];
    }
}

void BranchAndBound::separate(const ResidualGraph& graph, Prices& prices) {
    if (cliques_.size() >= kMostCliques) return;
    edge_alive_.assign(at(graph_.edge_count()), 0);
    for (int a = 0; a < graph.size(); ++a) edge_alive_[at(graph.edge(a))] = 1;
    separation_.separate(graph_, edge_use_, edge_alive_, kCliquesPerRound, cliques_, clock_);
    prices.clique.resize(at(cliques_.size()), 0.0);
}

/// Drops what cannot be in a better pair; false where that is too little to renumber for.
bool BranchAndBound::fix(Node& here) {
    const ResidualGraph& graph = here.graph;
    const double limit = cutoff() + relaxation_.offset();
    keep_out_.assign(graph.out_arc.size(), 0);
    order_.clear();
    std::size_t kept = 0;
    for (int a = 0; a < graph.size(); ++a) {
        bool alive = false;
        for (int kind = 0; kind < relaxation_.system().kind_count; ++kind) {
            const std::span<const double> forward = relaxation_.forward(kind);
            const std::span<const double> backward = relaxation_.backward(kind);
            if (!(forward[at(a)] + backward[at(a)] < limit)) continue;
            alive = true;
            for (int position = graph.out_start[at(a)]; position < graph.out_start[at(a) + 1]; ++position) {
                const std::size_t next = at(graph.out_arc[at(position)]);
                if (keep_out_[at(position)] == 0 && forward[at(a)] + graph.out_cost[at(position)] +
                                                            relaxation_.reduced()[next] + backward[next] <
                                                        limit) {
                    keep_out_[at(position)] = 1;
                    ++kept;
                }
            }
        }
        if (alive) order_.push_back(a);
    }
    if (10 * (order_.size() + kept) > 9 * (graph.arc.size() + graph.out_arc.size())) return false;
    spare_.filter(graph, order_, keep_out_, index_);
    std::swap(spare_, here.graph);
    return true;
}

void BranchAndBound::decide(const Branching& branching, bool in, bool back) {
    if (branching.on == Branching::On::edge) {
        if (in) decisions_.require_edge(graph_, branching.what, !back);
    } else {
        decisions_.decide_end(branching.what, back ? Decisions::End::open
                                              : in ? Decisions::End::always
                                                   : Decisions::End::never);
    }
}

void BranchAndBound::branch(const ResidualGraph& source, const Branching& branching, bool in,
                            ResidualGraph& target) {
    order_.clear();
    keep_out_.assign(source.out_arc.size(), 1);
    if (branching.on == Branching::On::end) {
        for (int a = 0; a < source.size(); ++a) {
            if (!in || source.tail[at(a)] != branching.what) order_.push_back(a);
        }
        target.filter(source, order_, keep_out_, index_);
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
            const int cone = source.head[at(a)];
            if ((cone != ends[0] && cone != ends[1]) || source.edge(a) == edge) continue;
            for (int p = source.out_start[at(a)]; p < source.out_start[at(a) + 1]; ++p) {
                if (source.edge(source.out_arc[at(p)]) != edge) keep_out_[at(p)] = 0;
            }
        }
    }
    target.filter(source, order_, keep_out_, index_);
}

BranchAndBound::Branching BranchAndBound::choose(const ResidualGraph& graph) const {
    Branching best{Branching::On::nothing, -1, 0.0};
    double best_score = -1.0;
    const auto doubt = [](double use) { return std::min(use, std::max(0.0, 1.0 - use)); };
    if (relaxation_.symmetric()) {
        for (const int cone : relaxation_.ends()) {
            if (cone < 0 || decisions_.end(cone) != Decisions::End::open) continue;
            const double use = end_use_[at(cone)];
            if (use >= 1.0 - kLeastEndDoubt || use <= best_score) continue;
            best = {Branching::On::end, cone, use};
            best_score = use;
        }
        if (best.on != Branching::On::nothing) return best;
    }
    best_score = -1.0;
    for (int a = 0; a < graph.size(); ++a) {
        const int edge = graph.edge(a);
        const double use = edge_use_[at(edge)];
        if (decisions_.edge_required(edge) || doubt(use) <= best_score) continue;
        best = {Branching::On::edge, edge, use};
        best_score = doubt(use);
    }
    return best;
}

}  // namespace conelane::path_pair
