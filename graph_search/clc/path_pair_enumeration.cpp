#include "graph_search/clc/path_pair_enumeration.hpp"

#include <algorithm>

namespace conelane {
namespace {

/// Iterations between two computations of the memory in use.
constexpr std::int64_t kIterationsPerSum = 32;

constexpr Vertex kNoVertex = ~Vertex{0};
constexpr std::uint32_t kNoOption = ~std::uint32_t{0};

/// The finaliser of SplitMix64 (Steele, Lea and Flood): a bijection that looks random.
std::uint64_t scatter(std::uint64_t bits) {
    bits += 0x9e3779b97f4a7c15U;
    bits = (bits ^ (bits >> 30U)) * 0xbf58476d1ce4e5b9U;
    bits = (bits ^ (bits >> 27U)) * 0x94d049bb133111ebU;
    return bits ^ (bits >> 31U);
}

constexpr std::size_t kFirstSlots = 1024;

}  // namespace

void PathPairFingerprint::add(Side side, Vertex vertex) {
    value_ = scatter(value_ + 2 * std::uint64_t{vertex} + side);
}

void FingerprintSet::clear() {
    std::ranges::fill(slots_, 0);
    used_ = 0;
}

bool FingerprintSet::insert(const PathPairFingerprint& fingerprint) {
    if (2 * used_ >= slots_.size()) grow();
    const std::uint64_t value = std::max<std::uint64_t>(fingerprint.value(), 1);
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = value & mask;
    for (; slots_[slot] != 0; slot = (slot + 1) & mask) {
        if (slots_[slot] == value) return false;
    }
    slots_[slot] = value;
    ++used_;
    return true;
}

void FingerprintSet::grow() {
    std::vector<std::uint64_t> old(std::max(kFirstSlots, 2 * slots_.size()), 0);
    old.swap(slots_);
    const std::size_t mask = slots_.size() - 1;
    for (const std::uint64_t value : old) {
        if (value == 0) continue;
        std::size_t slot = value & mask;
        while (slots_[slot] != 0) slot = (slot + 1) & mask;
        slots_[slot] = value;
    }
}

void PathPairs::clear() {
    steps_.clear();
    found_.clear();
    features_.clear();
    known_.clear();
}

std::uint32_t PathPairs::add_step(std::uint32_t before, Side side, Vertex vertex) {
    steps_.push_back({before, vertex, static_cast<std::uint8_t>(side)});
    return static_cast<std::uint32_t>(steps_.size() - 1);
}

PathPairVertices PathPairs::vertices(const PathPair& pair, PathPairVertices vertices) const {
    for (std::vector<Vertex>& side : vertices) side.clear();
    for (std::uint32_t step = pair.last_step; step != kNone; step = steps_[step].before)
        vertices[steps_[step].side].push_back(steps_[step].vertex);
    for (std::vector<Vertex>& side : vertices) std::ranges::reverse(side);
    return vertices;
}

std::size_t PathPairs::bytes() const {
    return steps_.size() * sizeof(Step) + found_.size() * (sizeof(PathPair) + 4 * sizeof(std::uint64_t)) +
           features_.size() * sizeof(LaneFeatures);
}

std::size_t PathPairs::add_lane(const PathPair& pair, const PathPairFingerprint& fingerprint,
                                const LaneConstraints& boundaries, const LaneGrowth& growth,
                                const EnumerationRules& rules) {
    const BoundaryArrays& left = boundaries.width().boundary(kLeft);
    const BoundaryArrays& right = boundaries.width().boundary(kRight);
    if (left.size < 2 || right.size < 2) return 0;
    if (!known_.insert(fingerprint)) return 0;
    found_.push_back(pair);
    if (rules.with_features) {
        features_.push_back(growth.features());
        add_width_features(boundaries.width(), growth.near_vertices(), features_.back());
    }
    return left.size + right.size + add_closed(pair, boundaries, rules);
}

std::size_t PathPairs::add_closed(const PathPair& pair, const LaneConstraints& boundaries,
                                  const EnumerationRules& rules) {
    const BoundaryArrays& left = boundaries.width().boundary(kLeft);
    const BoundaryArrays& right = boundaries.width().boundary(kRight);
    const double left_gap_m = (left.vertex(left.size - 1) - left.vertex(0)).norm();
    const double right_gap_m = (right.vertex(right.size - 1) - right.vertex(0)).norm();
    if (left_gap_m > rules.d_max_m || right_gap_m > rules.d_max_m) return 0;
    for (const Side side : {kLeft, kRight}) {
        const BoundaryArrays& boundary = boundaries.width().boundary(side);
        closing_points_[side].clear();
        for (std::size_t i = 0; i < boundary.size; ++i) closing_points_[side].push_back(boundary.vertex(i));
    }
    // Every segment is tested against every other one, several times.
    const std::size_t work = 4 * (left.size + right.size) * (left.size + right.size);
    if (!can_be_closed(closing_points_[kLeft], closing_points_[kRight], rules.d_max_m, rules.bounds))
        return work;
    found_.push_back(
        {pair.last_step, true, pair.iteration, pair.length_m + (left_gap_m + right_gap_m) / 2.0});
    if (rules.with_features) {
        LaneFeatures features = features_.back();
        const PaperFeatures closed = paper_features(closing_points_[kLeft], closing_points_[kRight], true);
        std::ranges::copy(closed, features.begin());
        features_.push_back(features);
    }
    return work;
}

bool PathPairEnumeration::run(const SearchGraph& graph, StartPair start, const Point& heading,
                              const EnumerationRules& rules, SearchBudget& budget, PathPairs& pairs,
                              const PathPairVertices& guide) {
    if (budget.read_clock()) return false;
    begin(graph, start, heading, rules, pairs, guide);
    std::size_t options = next_vertex_->option_count();
    while (!calls_.empty()) {
        if (budget.iterations % kIterationsPerSum == 0) {
            (void)budget.occupy(pairs.bytes() + next_vertex_->option_count() * sizeof(NextVertex));
        }
        if (budget.spent()) return false;
        ++budget.iterations;
        Call& call = calls_.back();
        const LaneConstraints::State& lane = constraints_.state();
        const std::array<bool, 2> extensible{drop_visited(call, kLeft), drop_visited(call, kRight)};
        const bool given_up = lane.backtrack(extensible[kLeft], extensible[kRight]);
        if (given_up || (!extensible[kLeft] && !extensible[kRight])) {
            end_call();
            continue;
        }
        const Choice choice = choose(call, extensible);
        extend(choice, extensible, budget, pairs);
        // Measuring the lane takes time proportional to its length; options are sorted as they come.
        const std::size_t measured =
            constraints_.width().boundary(kLeft).size + constraints_.width().boundary(kRight).size;
        (void)budget.spend(50 + measured + 10 * (next_vertex_->option_count() - options));
        options = next_vertex_->option_count();
    }
    return true;
}

void PathPairEnumeration::begin(const SearchGraph& graph, StartPair start, const Point& heading,
                                const EnumerationRules& rules, PathPairs& pairs,
                                const PathPairVertices& guide) {
    graph_ = &graph;
    rules_ = rules;
    start_ = start;
    phi_max_ = turning_measure(rules.bounds.phi_max_rad);
    next_vertex_ = rules.next_vertex;
    if (next_vertex_ == nullptr) {
        next_vertex_ = &own_next_vertex_;
        next_vertex_->reset(graph, rules.next_vertex_distance_weight / rules.d_max_m, rules.reach);
    }
    constraints_.reset(graph.position(start.left), graph.position(start.right), rules.bounds,
                       rules.width_backtracking);
    for (std::vector<std::uint8_t>& side : on_path_) side.assign(graph.vertex_count(), 0);
    on_path_[kLeft][start.left] = 1;
    on_path_[kRight][start.right] = 1;
    Call first{.unvisited = {next_vertex_->after_start(start.left, heading),
                             next_vertex_->after_start(start.right, heading)},
               .tried = {0, 0},
               .discrepancies = 0,
               .visited_early = {kNoVertex, kNoVertex},
               .last = {start.left, start.right},
               .direction = {heading, heading},
               .length_m = {0.0, 0.0},
               .fingerprint = PathPairFingerprint(start),
               .growth = {},
               .step = pairs.add_step(PathPairs::kNone, kLeft, start.left),
               .pushed = kLeft};
    first.step = pairs.add_step(first.step, kRight, start.right);
    if (rules_.with_features) first.growth.start(graph, start.left, start.right, heading);
    calls_.assign(1, first);
    guide_ = guide;
    guide_position_ = {1, 1};
    follows_guide_ = guide_[kLeft].size() > 1 || guide_[kRight].size() > 1;
}

void PathPairEnumeration::end_call() {
    const Call& call = calls_.back();
    if (calls_.size() > 1) {
        on_path_[call.pushed][call.last[call.pushed]] = 0;
        constraints_.pop(call.pushed);
    }
    calls_.pop_back();
    follows_guide_ = false;
}

PathPairEnumeration::Choice PathPairEnumeration::choose(Call& call, const std::array<bool, 2>& extensible) {
    NextOptions options{kNoOption, kNoOption};
    if (follows_guide_) options = guided_options(call);
    const bool guided = options != NextOptions{kNoOption, kNoOption};
    follows_guide_ = guided;
    if (!guided) {
        for (const Side side : {kLeft, kRight}) {
            if (extensible[side]) options[side] = call.unvisited[side].begin;
        }
    }
    Side side = options[kLeft] != kNoOption ? kLeft : kRight;
    if (options[kLeft] != kNoOption && options[kRight] != kNoOption) side = choose_side(call, options);
    const NextVertex next = next_vertex_->option(options[side]);
    if (guided) {
        call.visited_early[side] = next.vertex;
        ++guide_position_[side];
    } else {
        ++call.unvisited[side].begin;
        ++call.tried[side];
    }
    return {side, next, guided};
}

void PathPairEnumeration::extend(const Choice& choice, const std::array<bool, 2>& extensible,
                                 SearchBudget& budget, PathPairs& pairs) {
    const auto& [side, next, guided] = choice;
    const Vertex from = calls_.back().last[side];
    const bool first_segment = from == (side == kLeft ? start_.left : start_.right);
    const Point segment = graph_->position(next.vertex) - graph_->position(from);
    constraints_.push(side, graph_->position(next.vertex), first_segment || next.turning < phi_max_);
    const LaneConstraints::State& extended = constraints_.state();
    if (!extended.feasible && extended.backtrack(extensible[kLeft], extensible[kRight])) {
        constraints_.pop(side);
        follows_guide_ = false;
        return;
    }
    calls_.push_back(calls_.back());
    Call& below = calls_.back();
    if (!guided) below.discrepancies += below.tried[side] - 1;
    below.tried[side] = 0;
    below.last[side] = next.vertex;
    below.direction[side] = segment;
    below.length_m[side] += segment.norm();
    below.fingerprint.add(side, next.vertex);
    if (rules_.with_features) below.growth.push(*graph_, side, next.vertex);
    below.step = pairs.add_step(below.step, side, next.vertex);
    below.pushed = side;
    if (extended.feasible) {
        const double length_m = (below.length_m[kLeft] + below.length_m[kRight]) / 2.0;
        (void)budget.spend(pairs.add_lane({below.step, false, budget.iterations, length_m}, below.fingerprint,
                                          constraints_, below.growth, rules_));
    }
    below.unvisited[side] = next_vertex_->after(from, next.vertex, next.edge);
    below.visited_early[side] = kNoVertex;
    on_path_[side][next.vertex] = 1;
}

bool PathPairEnumeration::drop_visited(Call& call, Side side) const {
    if (call.discrepancies + call.tried[side] > rules_.max_discrepancies) return false;
    NextVertexDecider::Range& unvisited = call.unvisited[side];
    while (unvisited.begin != unvisited.end) {
        const Vertex vertex = next_vertex_->option(unvisited.begin).vertex;
        if (on_path_[side][vertex] == 0 && vertex != call.visited_early[side]) return true;
        ++unvisited.begin;
    }
    return false;
}

PathPairEnumeration::NextOptions PathPairEnumeration::guided_options(const Call& call) {
    NextOptions options{kNoOption, kNoOption};
    for (const Side side : {kLeft, kRight}) {
        if (guide_position_[side] >= guide_[side].size()) continue;
        const NextVertexDecider::Range& unvisited = call.unvisited[side];
        for (std::uint32_t i = unvisited.begin; i != unvisited.end; ++i) {
            const Vertex vertex = next_vertex_->option(i).vertex;
            if (vertex == guide_[side][guide_position_[side]] && on_path_[side][vertex] == 0)
                options[side] = i;
        }
        // The guide ends where the graph or a constraint does not allow its next vertex.
        if (options[side] == kNoOption) guide_position_[side] = guide_[side].size();
    }
    return options;
}

Side PathPairEnumeration::choose_side(const Call& call, const NextOptions& options) const {
    const std::array<bool, 2>& needs = constraints_.state().needs;
    if (needs[kLeft] != needs[kRight]) return needs[kLeft] ? kLeft : kRight;
    std::array<BoundaryTip, 2> tips;
    std::array<Vertex, 2> next{};
    for (const Side side : {kLeft, kRight}) {
        next[side] = next_vertex_->option(options[side]).vertex;
        tips[side] = {graph_->position(call.last[side]), call.direction[side], graph_->position(next[side])};
    }
    return left_right_decision(tips, next[kLeft] < next[kRight] ? kLeft : kRight);
}

}  // namespace conelane
