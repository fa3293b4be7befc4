#include "graph_search/lane_neighbourhood.hpp"

#include "graph_search/left_right.hpp"
#include "graph_search/next_vertex.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace conelane {

void LaneNeighbourhood::run(const SearchGraph& graph, const PathPairVertices& lane,
                            const PathPairVertices& starts, const Point& heading,
                            const EnumerationRules& rules, SearchBudget& budget, PathPairs& pairs) {
    graph_ = &graph;
    lane_ = &lane;
    budget_ = &budget;
    rules_ = rules;
    phi_max_ = turning_measure(rules.bounds.phi_max_rad);
    heading_ = heading;

    Tips tips = start(lane[kLeft].front(), lane[kRight].front());
    Rest rest{std::span(lane[kLeft]).subspan(1), std::span(lane[kRight]).subspan(1)};
    // The side that goes first comes first here too, so that a mirrored lane is searched alike.
    const Side first = next_side(tips, rest);
    try_detours(tips, first, 0, rest, pairs);
    try_detours(tips, opposite(first), 0, rest, pairs);
    while (!budget.spent() && !(rest[kLeft].empty() && rest[kRight].empty())) {
        const Side side = next_side(tips, rest);
        if (!push(tips, side, rest[side].front())) break;
        rest[side] = rest[side].subspan(1);
        if (tips.length_m[side] > kDetourRange_m) continue;
        try_detours(tips, side, lane[side].size() - 1 - rest[side].size(), rest, pairs);
    }
    try_starts(first, starts[first], pairs);
    try_starts(opposite(first), starts[opposite(first)], pairs);
}

LaneNeighbourhood::Tips LaneNeighbourhood::start(Vertex left, Vertex right) {
    pushed_.clear();
    pushed_.push_back({kLeft, left});
    pushed_.push_back({kRight, right});
    constraints_.reset(graph_->position(left), graph_->position(right), rules_.bounds,
                       rules_.width_backtracking);
    Tips tips{{left, right}, {heading_, heading_}, {0.0, 0.0}, {}};
    if (rules_.with_features) tips.growth.start(*graph_, left, right, heading_);
    return tips;
}

bool LaneNeighbourhood::push(Tips& tips, Side side, Vertex vertex) {
    ++budget_->iterations;
    const Point added = segment(tips.last[side], vertex);
    const bool turn_allowed = tips.length_m[side] == 0.0 || !turns_too_far(tips.direction[side], added);
    constraints_.push(side, graph_->position(vertex), turn_allowed);
    pushed_.push_back({side, vertex});
    if (constraints_.state().hopeless) return false;
    if (rules_.with_features) tips.growth.push(*graph_, side, vertex);
    tips.last[side] = vertex;
    tips.direction[side] = added;
    tips.length_m[side] += added.norm();
    return true;
}

Side LaneNeighbourhood::next_side(const Tips& tips, const Rest& rest) const {
    if (rest[kLeft].empty() || rest[kRight].empty()) return rest[kLeft].empty() ? kRight : kLeft;
    const std::array<bool, 2>& needs = constraints_.state().needs;
    if (needs[kLeft] != needs[kRight]) return needs[kLeft] ? kLeft : kRight;
    std::array<BoundaryTip, 2> boundary_tips;
    for (const Side side : {kLeft, kRight}) {
        boundary_tips[side] = {graph_->position(tips.last[side]), tips.direction[side],
                               graph_->position(rest[side].front())};
    }
    return left_right_decision(boundary_tips, rest[kLeft].front() < rest[kRight].front() ? kLeft : kRight);
}

void LaneNeighbourhood::complete(Tips tips, Rest rest, PathPairs& pairs) {
    const std::size_t before = pushed_.size();
    bool goes_on = true;
    while (goes_on && !(rest[kLeft].empty() && rest[kRight].empty())) {
        const Side side = next_side(tips, rest);
        goes_on = !budget_->spent() && push(tips, side, rest[side].front());
        rest[side] = rest[side].subspan(1);
    }
    if (goes_on && constraints_.state().feasible) {
        std::uint32_t step = PathPairs::kNone;
        for (const Pushed& pushed : pushed_) step = pairs.add_step(step, pushed.side, pushed.vertex);
        const double length_m = (tips.length_m[kLeft] + tips.length_m[kRight]) / 2.0;
        pairs.add_lane({step, false, budget_->iterations, length_m}, constraints_, tips.growth, rules_);
    }
    for (; pushed_.size() > before; pushed_.pop_back()) constraints_.pop(pushed_.back().side);
}

void LaneNeighbourhood::try_detours(const Tips& tips, Side side, std::size_t at, Rest rest,
                                    PathPairs& pairs) {
    const std::vector<Vertex>& boundary = (*lane_)[side];
    const Vertex from = boundary[at];
    // Over `via`, or straight where there is none, to the vertex in place `to`; past the last one: to the
    // end.
    const auto try_detour = [&](std::optional<Vertex> via, std::size_t to) {
        if (budget_->spent()) return;
        const Vertex last = via.value_or(from);
        const bool turns = via || at > 0;
        const Point before = via ? segment(from, *via) : tips.direction[side];
        if (to < boundary.size()) {
            if (!graph_->adjacent(last, boundary[to])) return;
            const Point back = segment(last, boundary[to]);
            if (turns && turns_too_far(before, back)) return;
            if (to + 1 < boundary.size() && turns_too_far(back, segment(boundary[to], boundary[to + 1]))) {
                return;
            }
        }
        detoured_.clear();
        if (via) detoured_.push_back(*via);
        detoured_.insert(detoured_.end(), boundary.begin() + static_cast<std::ptrdiff_t>(to), boundary.end());
        rest[side] = detoured_;
        complete(tips, rest, pairs);
    };
    const std::size_t last_to = std::min(at + 1 + kMostLeftOut, boundary.size());
    for (std::size_t to = at + 2; to <= last_to; ++to) try_detour(std::nullopt, to);
    vias_.clear();
    for (const Vertex via : graph_->neighbours(from)) {
        if (is_on_lane(via)) continue;
        if (at > 0 && turns_too_far(tips.direction[side], segment(from, via))) continue;
        vias_.push_back(via);
    }
    // By what they are like and not by how they are numbered.
    std::ranges::sort(vias_, {},
                      [&](Vertex via) { return std::pair(segment(from, via).squaredNorm(), via); });
    for (const Vertex via : vias_) {
        for (std::size_t to = at + 1; to <= last_to; ++to) try_detour(via, to);
    }
}

void LaneNeighbourhood::try_starts(Side side, std::span<const Vertex> starts, PathPairs& pairs) {
    const std::span<const Vertex> boundary((*lane_)[side]);
    const Vertex facing = (*lane_)[opposite(side)].front();
    const auto try_start = [&](Vertex vertex, std::span<const Vertex> rest) {
        if (budget_->spent()) return;
        Rest both;
        both[side] = rest;
        both[opposite(side)] = std::span((*lane_)[opposite(side)]).subspan(1);
        complete(start(side == kLeft ? vertex : facing, side == kLeft ? facing : vertex), both, pairs);
    };
    try_start(boundary[1], boundary.subspan(2));
    for (const Vertex vertex : starts) {
        if (is_on_lane(vertex)) continue;
        for (std::size_t to = 0; to <= kMostLeftOut && to < boundary.size(); ++to) {
            if (graph_->adjacent(vertex, boundary[to])) try_start(vertex, boundary.subspan(to));
        }
    }
}

bool LaneNeighbourhood::turns_too_far(const Point& before, const Point& after) const {
    return turning_measure(before, after) >= phi_max_;
}

Point LaneNeighbourhood::segment(Vertex from, Vertex to) const {
    return graph_->position(to) - graph_->position(from);
}

bool LaneNeighbourhood::is_on_lane(Vertex vertex) const {
    return std::ranges::any_of(*lane_, [&](const std::vector<Vertex>& boundary) {
        return std::ranges::find(boundary, vertex) != boundary.end();
    });
}

}  // namespace conelane
