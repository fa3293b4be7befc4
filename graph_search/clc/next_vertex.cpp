#include "graph_search/clc/next_vertex.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace conelane {
namespace {

/// Up to about this number, insertion sort is fastest.
constexpr std::size_t kFew = 48;

/// Stable: the options come in the order of their vertices, so equal ones stay in that order.
void sort_by_cost(std::span<NextVertex> options) {
    if (options.size() > kFew) {
        std::ranges::sort(options, {},
                          [](const NextVertex& option) { return std::pair(option.cost, option.vertex); });
        return;
    }
    for (std::size_t i = 1; i < options.size(); ++i) {
        const NextVertex option = options[i];
        std::size_t place = i;
        for (; place > 0 && options[place - 1].cost > option.cost; --place)
            options[place] = options[place - 1];
        options[place] = option;
    }
}

}  // namespace

void NextVertexDecider::reset(const SearchGraph& graph, double distance_weight_per_m, StepReach* reach) {
    graph_ = &graph;
    reach_ = reach;
    if (reach_ == nullptr) all_.reset(graph, 0);
    distance_weight_per_m_ = distance_weight_per_m;
    options_.clear();
    ranges_.assign(graph.directed_edge_count(), Range{kUnknown, kUnknown});
}

NextVertexDecider::Range NextVertexDecider::after_start(Vertex start, const Point& heading) {
    return sorted(start, heading);
}

NextVertexDecider::Range NextVertexDecider::sorted(Vertex vertex, const Point& direction) {
    const auto begin = static_cast<std::uint32_t>(options_.size());
    const SearchGraph::DirectedEdge first = graph_->first_edge(vertex);
    const std::span<const Vertex> neighbours = graph_->neighbours(vertex);
    for (const std::uint32_t place : (reach_ != nullptr ? *reach_ : all_).steps(vertex)) {
        const Vertex neighbour = neighbours[place];
        const Point segment = graph_->position(neighbour) - graph_->position(vertex);
        const double turning = turning_measure(direction, segment);
        double cost = turning;
        if (distance_weight_per_m_ > 0.0) cost += distance_weight_per_m_ * segment.norm();
        options_.push_back({neighbour, first + place, turning, cost});
    }
    sort_by_cost(std::span(options_).subspan(begin));
    return {begin, static_cast<std::uint32_t>(options_.size())};
}

}  // namespace conelane
