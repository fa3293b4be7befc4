#include "evaluation/proofs/walk_bounds.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace conelane {
namespace {

constexpr std::size_t kNowhere = std::numeric_limits<std::size_t>::max();

}  // namespace

WalkGraph all_walks(const ExactScene& scene, const LegKinds& kinds) {
    WalkGraph graph;
    std::vector<std::size_t> place(scene.successions.size(), kNowhere);
    const auto reach = [&](std::size_t arc) {
        if (place[arc] != kNowhere) return;
        place[arc] = graph.arc.size();
        graph.arc.push_back(arc);
    };
    for (std::size_t arc = 0; arc < scene.successions.size(); ++arc) {
        const std::size_t tail = scene.tail(arc);
        if (std::ranges::any_of(kinds.start, [&](const auto& start) { return start[tail]; })) reach(arc);
    }
    for (std::size_t done = 0; done < graph.arc.size(); ++done) {
        const std::vector<ExactScene::Succession>& successions = scene.successions[graph.arc[done]];
        for (const ExactScene::Succession& next : successions) reach(next.arc);
        std::vector<WalkGraph::Turn>& turns = graph.turns.emplace_back();
        for (const ExactScene::Succession& next : successions) turns.push_back({place[next.arc], next.cost});
    }
    return graph;
}

WalkBounds::WalkBounds(const ExactScene& scene, const LegKinds& kinds, WalkPrices prices)
    : scene_(scene), kinds_(kinds), prices_(std::move(prices)) {}

bool WalkBounds::find(const WalkGraph& graph) {
    graph_ = &graph;
    reduced_.clear();
    for (const std::size_t arc : graph.arc)
        reduced_.push_back(prices_.edge[arc / 2] + prices_.cone[scene_.head(arc)]);
    forward_.assign(kinds_.count(), {});
    for (std::size_t kind = 0; kind < kinds_.count(); ++kind) {
        if (!find_forward(kind)) return false;
    }
    find_rest();
    return true;
}

WalkCost WalkBounds::start(std::size_t kind, std::size_t place) const {
    const std::size_t tail = scene_.tail(graph_->arc[place]);
    if (!kinds_.start[kind][tail]) return std::nullopt;
    return scene_.end_cost[tail] + prices_.cone[tail] + reduced_[place];
}

WalkCost WalkBounds::end(std::size_t kind, std::size_t place) const {
    const std::size_t head = scene_.head(graph_->arc[place]);
    return kinds_.end[kind][head] ? WalkCost(scene_.end_cost[head]) : std::nullopt;
}

bool WalkBounds::find_forward(std::size_t kind) {
    std::vector<WalkCost>& walk = forward_[kind];
    for (std::size_t a = 0; a < graph_->arc.size(); ++a) walk.push_back(start(kind, a));
    for (std::size_t round = 0; round <= walk.size(); ++round) {
        bool shorter = false;
        for (std::size_t a = 0; a < walk.size(); ++a) {
            if (!walk[a]) continue;
            for (const WalkGraph::Turn& turn : graph_->turns[a]) {
                const Exact cost = *walk[a] + turn.cost + reduced_[turn.to];
                if (walk[turn.to] && *walk[turn.to] <= cost) continue;
                walk[turn.to] = cost;
                shorter = true;
            }
        }
        if (!shorter) return true;
    }
    return false;
}

void WalkBounds::find_rest() {
    const std::size_t cones = prices_.cone.size();
    best_.assign(kinds_.count(), std::vector<WalkCost>(cones));
    rest_ = best_;
    for (std::size_t kind = 0; kind < kinds_.count(); ++kind) {
        for (std::size_t a = 0; a < graph_->arc.size(); ++a) {
            const WalkCost cost = sum(forward_[kind][a], end(kind, a));
            WalkCost& best = best_[kind][scene_.head(graph_->arc[a])];
            if (cheaper(cost, best)) best = cost;
        }
    }
    for (std::size_t kind = 0; kind < kinds_.count(); ++kind) {
        const std::vector<WalkCost>& others = best_[kinds_.other(kind)];
        for (std::size_t f = 0; f < cones; ++f) {
            for (std::size_t g = 0; g < cones; ++g) {
                if (kinds_.partners != nullptr && !(*kinds_.partners)[f][g]) continue;
                if (cheaper(others[g], rest_[kind][f])) rest_[kind][f] = others[g];
            }
        }
    }
}

Exact WalkBounds::bound() const {
    WalkCost least;
    for (std::size_t kind = 0; kind < kinds_.count(); ++kind) {
        for (std::size_t f = 0; f < best_[kind].size(); ++f) {
            const WalkCost pair = sum(best_[kind][f], rest_[kind][f]);
            if (cheaper(pair, least)) least = pair;
        }
    }
    return least ? Exact(*least - prices_.offset) : std::numeric_limits<Exact>::max();
}

std::vector<WalkCost> WalkBounds::backward(std::size_t kind, std::span<const WalkCost> last) const {
    std::vector<WalkCost> way(last.begin(), last.end());
    // No walk gains from a cycle, so this ends.
    for (bool shorter = true; shorter;) {
        shorter = false;
        for (std::size_t a = way.size(); a-- > 0;) {
            if (!forward_[kind][a]) continue;
            for (const WalkGraph::Turn& turn : graph_->turns[a]) {
                const WalkCost cost = sum(way[turn.to], Exact(turn.cost + reduced_[turn.to]));
                if (!cheaper(cost, way[a])) continue;
                way[a] = cost;
                shorter = true;
            }
        }
    }
    return way;
}

std::vector<WalkCost> WalkBounds::onward(std::size_t kind) const {
    std::vector<WalkCost> last;
    for (std::size_t a = 0; a < graph_->arc.size(); ++a) last.push_back(end(kind, a));
    return backward(kind, last);
}

WalkGraph WalkBounds::below(const WalkGraph& graph, const Exact& limit) const {
    const Exact most = limit + prices_.offset;
    std::vector<std::vector<WalkCost>> ways;
    for (std::size_t kind = 0; kind < kinds_.count(); ++kind) {
        std::vector<WalkCost> last;
        for (std::size_t a = 0; a < graph.arc.size(); ++a)
            last.push_back(sum(end(kind, a), rest_[kind][scene_.head(graph.arc[a])]));
        ways.push_back(backward(kind, last));
    }
    const auto is_below = [&](std::size_t a, const Exact& on, std::size_t b) {
        for (std::size_t kind = 0; kind < kinds_.count(); ++kind) {
            const WalkCost cost = sum(sum(forward_[kind][a], on), ways[kind][b]);
            if (cost && *cost < most) return true;
        }
        return false;
    };
    WalkGraph left;
    std::vector<std::size_t> place(graph.arc.size(), kNowhere);
    for (std::size_t a = 0; a < graph.arc.size(); ++a) {
        if (!is_below(a, 0, a)) continue;
        place[a] = left.arc.size();
        left.arc.push_back(graph.arc[a]);
    }
    left.turns.resize(left.arc.size());
    for (std::size_t a = 0; a < graph.arc.size(); ++a) {
        if (place[a] == kNowhere) continue;
        for (const WalkGraph::Turn& turn : graph.turns[a]) {
            if (place[turn.to] == kNowhere || !is_below(a, Exact(turn.cost + reduced_[turn.to]), turn.to))
                continue;
            left.turns[place[a]].push_back({place[turn.to], turn.cost});
        }
    }
    return left;
}

}  // namespace conelane
