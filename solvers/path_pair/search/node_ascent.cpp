#include "solvers/path_pair/search/node_ascent.hpp"

namespace conelane::path_pair {

/// Of certificates, by arc: more than rounding, less than their unit.
constexpr double kCycleMargin = 1e-10;

void MultiplierStages::round(Multipliers& multipliers) {
    for (double& multiplier : multipliers.cone) multiplier = unit_ * std::ceil(multiplier / unit_);
    for (double& multiplier : multipliers.clique) multiplier = unit_ * std::ceil(multiplier / unit_);
    multipliers.heading = unit_ * std::floor(multipliers.heading / unit_);
    evaluated_ = multipliers;
}

NodeAscent::NodeAscent(const Context& context)
    : graph_(context.graph),
      incumbent_(context.incumbent),
      options_(context.options),
      cliques_(context.cliques),
      decisions_(context.decisions),
      clock_(context.clock),
      relaxation_(graph_, context.system, cliques_, decisions_, clock_),
      completion_(graph_, relaxation_, incumbent_, context.second_leg, clock_),
      frontiers_(graph_, relaxation_, incumbent_, options_, clock_),
      smoothed_(graph_, context.system, options_.tuning.ascent, clock_) {}

void NodeAscent::restart(MultiplierStages* stages) {
    stages_ = stages;
    relaxation_.forget();
    relaxation_.set_cycle_margin(stages == nullptr ? 0.0 : kCycleMargin);
    usage_.reset(graph_);
}

Verdict NodeAscent::run(Node& node, const Rules& rules) {
    Verdict verdict = Verdict::open;
    for (begin(node, rules); verdict == Verdict::open && !is_done();) verdict = step(node, {});
    return verdict;
}

void NodeAscent::begin(const Node& node, const Rules& rules) {
    rules_ = rules;
    state_ = {};
    take_best_multipliers(node);
    // Only a required cone's multiplier may be negative.
    for (std::size_t v = 0; v < multipliers_.cone.size(); ++v) {
        if (decisions_.visited()[v] == 0) multipliers_.cone[v] = std::max(0.0, multipliers_.cone[v]);
    }
    ascent_.restart(multipliers_);
}

Verdict NodeAscent::step(Node& node, const Aim& aim) {
    if (clock_.out_of_time()) return Verdict::stopped;
    if (rules_.smooths && state_.step == tuning().smoothed_step) smooth(node.graph);
    state_.value = evaluate(node.graph);
    if (state_.value == -kUnreachable) return Verdict::stopped;
    note_value(node);
    node.bound = std::max(node.bound, state_.value);
    if (state_.value >= incumbent_.limit()) return Verdict::closed;
    relaxation_.evaluate_backward(node.graph);
    if (clock_.expired()) return Verdict::stopped;
    usage_.count(graph_, cliques_, node.graph, relaxation_, tuning().use_memory);
    if (options_.complete_walks && state_.step == state_.next_completion) complete_walks(node.graph);
    if (state_.value >= incumbent_.limit()) return Verdict::closed;
    state_.is_last = state_.step + 1 >= node.max_steps || state_.scale < rules_.patience.min_scale;
    if (state_.is_last) {
        take_best_multipliers(node);
        if (relaxation_.evaluate(node.graph, multipliers_) == -kUnreachable) return Verdict::stopped;
    }
    if (options_.search_frontiers) {
        const Verdict verdict = try_frontiers(node.graph);
        node.bound = std::max(node.bound, state_.best);
        if (verdict != Verdict::open) return verdict;
    }
    if (state_.is_last) return Verdict::open;
    move_multipliers(node, aim);
    if (options_.fix_arcs && fix(node.graph) && node.graph.arc.empty()) return Verdict::closed;
    ++state_.step;
    if (options_.clique_multipliers && rules_.separates_cliques &&
        state_.step % tuning().steps_per_separation == 0) {
        separate(node.graph);
    }
    return Verdict::open;
}

double NodeAscent::evaluate(const ResidualGraph& graph) {
    const double value = relaxation_.evaluate(graph, multipliers_);
    if (stages_ == nullptr || value == -kUnreachable) return value;
    stages_->round(multipliers_);
    return relaxation_.evaluate(graph, multipliers_);
}

void NodeAscent::smooth(const ResidualGraph& graph) {
    if (!smoothed_.find(graph, cliques_, multipliers_)) {
        multipliers_.clique.resize(to_index(cliques_.size()), 0.0);
        return;
    }
    ascent_.restart(multipliers_);
    state_.since_best = 0;
    state_.scale = tuning().scale_after;
}

void NodeAscent::take_best_multipliers(const Node& node) {
    multipliers_ = node.multipliers;
    multipliers_.clique.resize(to_index(cliques_.size()), 0.0);
}

void NodeAscent::note_value(Node& node) {
    state_.updates += node.graph.size() + static_cast<int>(node.graph.out_arc.size());
    if (state_.value > state_.best + tuning().min_gain * std::abs(incumbent_.cutoff() - state_.best)) {
        state_.since_best = 0;
    } else {
        ++state_.since_best;
    }
    if (state_.value > state_.best) {
        state_.best = state_.value;
        node.multipliers = multipliers_;
    }
}

void NodeAscent::complete_walks(const ResidualGraph& graph) {
    const double before = incumbent_.cutoff();
    const std::array<std::vector<int>, 2>& walks = relaxation_.walks();
    for (int leg = 0; leg < 2; ++leg) {
        completion_.complete(
            graph, relaxation_.symmetric() ? 0 : leg, walks[to_index(leg)],
            incumbent_.found() ? tuning().completion_tries : tuning().first_completion_tries);
    }
    const int wait = !incumbent_.found() ? 1 : incumbent_.cutoff() < before ? 2 : 4 + state_.step / 2;
    state_.next_completion = state_.step + wait;
}

Verdict NodeAscent::try_frontiers(const ResidualGraph& graph) {
    const FrontierTuning& tuning = options_.tuning.frontiers;
    const double gap = incumbent_.limit() - state_.value;
    Verdict verdict = Verdict::open;
    if (state_.is_last) {
        verdict = frontiers_.search_by_target(graph, rules_.last_search, state_.best);
    } else {
        const bool is_due = state_.step == rules_.first_try || (state_.step + 1) % tuning.steps_per_try == 0;
        if (!is_due || !(gap < tuning.retry_gap * state_.failed_gap)) return Verdict::open;
        const bool is_small = state_.step == 0 && graph.size() < tuning.small_graph_arcs;
        const std::int64_t max_frontiers =
            std::max(is_small ? tuning.first_frontiers_of_small_graph : tuning.first_frontiers,
                     state_.updates / tuning.updates_per_frontier);
        verdict = frontiers_.search(graph, {static_cast<std::size_t>(max_frontiers), tuning.max_labels,
                                            state_.step == 0 ? tuning.first_beam_width : 0});
    }
    if (verdict != Verdict::open) return verdict;
    state_.failed_gap = incumbent_.limit() - state_.value;
    state_.updates = 0;
    return Verdict::open;
}

void NodeAscent::move_multipliers(const Node& node, const Aim& aim) {
    if (state_.since_best < rules_.patience.steps) {
        ascent_.step(multipliers_, usage_.last(), decisions_.visited(), step_gap(aim), state_.scale);
        return;
    }
    // The steps were too long: shorter ones, from the best multipliers.
    state_.since_best = 0;
    state_.scale *= 0.5;
    take_best_multipliers(node);
    ascent_.restart(multipliers_);
}

/// Aiming at an incumbent from windows, which is nearer than one that the ascent finds, would take nearly
/// twice as many steps.
double NodeAscent::step_gap(const Aim& aim) const {
    const double gap = incumbent_.cutoff() - state_.value;
    if (incumbent_.cutoff() < aim.known_cost) return gap;
    return std::clamp(aim.outside_cost - state_.value, gap, tuning().max_overshoot * gap);
}

bool NodeAscent::fix(ResidualGraph& graph) {
    if (!fixing_.drop(relaxation_, incumbent_.limit() + relaxation_.offset(), graph)) return false;
    if (stages_ != nullptr) stages_->keep();
    return true;
}

void NodeAscent::separate(const ResidualGraph& graph) {
    if (cliques_.size() >= tuning().max_cliques) return;
    edge_alive_.assign(to_index(graph_.edge_count()), 0);
    for (int a = 0; a < graph.size(); ++a) edge_alive_[to_index(graph.edge(a))] = 1;
    separation_.separate(graph_, usage_.edges(), edge_alive_, tuning().cliques_per_separation, cliques_,
                         clock_);
    multipliers_.clique.resize(to_index(cliques_.size()), 0.0);
}

}  // namespace conelane::path_pair
