#include "graph_search/path_pair_enumeration.hpp"

#include "graph_search/lane_closing.hpp"
#include "graph_search/left_right.hpp"

#include <algorithm>

namespace conelane {
namespace {

/// The clock is read once in so many iterations.
constexpr std::int64_t kIterationsPerClockReading = 32;

}  // namespace

void PathPairs::clear() {
    steps_.clear();
    found_.clear();
    features_.clear();
}

std::uint32_t PathPairs::add_step(std::uint32_t before, Side side, Vertex vertex) {
    steps_.push_back({before, vertex, static_cast<std::uint8_t>(side)});
    return static_cast<std::uint32_t>(steps_.size() - 1);
}

PathPairVertices PathPairs::vertices(const PathPair& pair) const {
    PathPairVertices vertices;
    for (std::uint32_t step = pair.last_step; step != kNone; step = steps_[step].before) {
        vertices[steps_[step].side].push_back(steps_[step].vertex);
    }
    for (std::vector<Vertex>& side : vertices) std::ranges::reverse(side);
    return vertices;
}

bool PathPairEnumeration::run(const SearchGraph& graph, StartPair start, const Point& heading,
                              const EnumerationRules& rules, SearchBudget& budget, PathPairs& pairs) {
    graph_ = &graph;
    rules_ = rules;
    const double phi_max = turning_measure(rules.bounds.phi_max_rad);
    next_vertex_.reset(graph);
    constraints_.reset(graph.position(start.left), graph.position(start.right), rules.bounds,
                       rules.width_backtracking);
    for (std::vector<std::uint8_t>& side : on_path_) side.assign(graph.vertex_count(), 0);
    on_path_[kLeft][start.left] = 1;
    on_path_[kRight][start.right] = 1;

    Call first;
    first.unvisited = {next_vertex_.after_start(start.left, heading),
                       next_vertex_.after_start(start.right, heading)};
    first.last = {start.left, start.right};
    first.direction = {heading, heading};
    first.length_m = {0.0, 0.0};
    first.step = pairs.add_step(PathPairs::kNone, kLeft, start.left);
    first.step = pairs.add_step(first.step, kRight, start.right);
    first.pushed = kLeft;
    calls_.assign(1, first);

    while (!calls_.empty()) {
        if (budget.iterations % kIterationsPerClockReading == 0 &&
            budget.deadline != SearchBudget::Clock::time_point::max()) {
            budget.out_of_time = SearchBudget::Clock::now() >= budget.deadline;
        }
        if (budget.spent()) return false;
        ++budget.iterations;
        Call& call = calls_.back();
        const LaneConstraints::State& lane = constraints_.state();
        std::array<bool, 2> extensible{};
        for (const Side side : {kLeft, kRight}) {
            NextVertexDecider::Range& unvisited = call.unvisited[side];
            while (unvisited.begin != unvisited.end &&
                   on_path_[side][next_vertex_.option(unvisited.begin).vertex] != 0) {
                ++unvisited.begin;
            }
            extensible[side] = unvisited.begin != unvisited.end;
        }
        const bool given_up = rules_.backtracking && lane.backtrack(extensible[kLeft], extensible[kRight]);
        if (given_up || (!extensible[kLeft] && !extensible[kRight])) {
            if (calls_.size() > 1) {
                on_path_[call.pushed][call.last[call.pushed]] = 0;
                constraints_.pop(call.pushed);
            }
            calls_.pop_back();
            continue;
        }

        Side side = extensible[kLeft] ? kLeft : kRight;
        if (extensible[kLeft] && extensible[kRight]) side = choose_side(call);
        const NextVertex next = next_vertex_.option(call.unvisited[side].begin++);
        const Vertex from = call.last[side];
        const bool first_segment = from == (side == kLeft ? start.left : start.right);
        const Point segment = graph.position(next.vertex) - graph.position(from);
        constraints_.push(side, graph.position(next.vertex), first_segment || next.turning < phi_max);
        const LaneConstraints::State& extended = constraints_.state();
        const bool backtrack =
            rules_.backtracking && extended.backtrack(extensible[kLeft], extensible[kRight]);
        if (backtrack && !extended.feasible) {
            constraints_.pop(side);
            continue;
        }
        Call below = call;
        below.last[side] = next.vertex;
        below.direction[side] = segment;
        const double segment_m = segment.norm();
        below.length_m[side] += segment_m;
        if (rules_.with_features) {
            below.segment_lengths[side].add(segment_m);
            if (!first_segment) below.turns[side].add(turning_angle(call.direction[side], segment));
        }
        below.step = pairs.add_step(call.step, side, next.vertex);
        below.pushed = side;
        if (extended.feasible) record(below, budget.iterations, pairs);
        below.unvisited[side] = next_vertex_.after(from, next.vertex, next.edge);
        on_path_[side][next.vertex] = 1;
        calls_.push_back(below);
    }
    return true;
}

Side PathPairEnumeration::choose_side(const Call& call) const {
    const std::array<bool, 2>& needs = constraints_.state().needs;
    if (needs[kLeft] != needs[kRight]) return needs[kLeft] ? kLeft : kRight;
    std::array<BoundaryTip, 2> tips;
    std::array<Vertex, 2> next{};
    for (const Side side : {kLeft, kRight}) {
        next[side] = next_vertex_.option(call.unvisited[side].begin).vertex;
        tips[side] = {graph_->position(call.last[side]), call.direction[side], graph_->position(next[side])};
    }
    return left_right_decision(tips, next[kLeft] < next[kRight] ? kLeft : kRight);
}

void PathPairEnumeration::record(const Call& call, std::int64_t iteration, PathPairs& pairs) {
    const BoundaryArrays& left = constraints_.width().boundary(kLeft);
    const BoundaryArrays& right = constraints_.width().boundary(kRight);
    if (left.size < 2 || right.size < 2) return;
    const double length_m = (call.length_m[kLeft] + call.length_m[kRight]) / 2.0;
    pairs.add_found({call.step, false, iteration, length_m});
    if (rules_.with_features) pairs.add_features(features(call, length_m));

    const double left_gap_m = (left.vertex(left.size - 1) - left.vertex(0)).norm();
    const double right_gap_m = (right.vertex(right.size - 1) - right.vertex(0)).norm();
    if (left_gap_m > rules_.d_max_m || right_gap_m > rules_.d_max_m) return;
    for (const Side side : {kLeft, kRight}) {
        const BoundaryArrays& boundary = constraints_.width().boundary(side);
        closing_points_[side].clear();
        for (std::size_t i = 0; i < boundary.size; ++i) closing_points_[side].push_back(boundary.vertex(i));
    }
    if (can_be_closed(closing_points_[kLeft], closing_points_[kRight], rules_.d_max_m, rules_.bounds)) {
        pairs.add_found({call.step, true, iteration, length_m + (left_gap_m + right_gap_m) / 2.0});
        if (rules_.with_features) {
            pairs.add_features(lane_features(closing_points_[kLeft], closing_points_[kRight], true));
        }
    }
}

LaneFeatures PathPairEnumeration::features(const Call& call, double length_m) const {
    const OnlineLaneWidth& width = constraints_.width();
    return {length_m,
            static_cast<double>(width.boundary(kLeft).size),
            static_cast<double>(width.boundary(kRight).size),
            width.variance(),
            call.segment_lengths[kLeft].variance(),
            call.segment_lengths[kRight].variance(),
            call.turns[kLeft].variance(),
            call.turns[kRight].variance()};
}

}  // namespace conelane
