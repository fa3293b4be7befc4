#include "graph_search/clc/step_reach.hpp"

#include <algorithm>
#include <limits>
#include <span>

namespace conelane {

void StepReach::reset(const SearchGraph& graph, std::size_t most) {
    graph_ = &graph;
    most_ = most;
    squared_m2_.assign(graph.vertex_count(), -1.0);
    first_.resize(graph.vertex_count());
    count_.resize(graph.vertex_count());
    allowed_.clear();
}

void StepReach::find(Vertex vertex) {
    const std::span<const Vertex> neighbours = graph_->neighbours(vertex);
    first_[vertex] = static_cast<std::uint32_t>(allowed_.size());
    double& reach_m2 = squared_m2_[vertex];
    if (most_ == 0 || neighbours.size() <= most_) {
        reach_m2 = std::numeric_limits<double>::infinity();
        for (std::uint32_t i = 0; i < neighbours.size(); ++i) allowed_.push_back(i);
    } else {
        distances_m2_.clear();
        for (const Vertex neighbour : neighbours)
            distances_m2_.push_back((graph_->position(neighbour) - graph_->position(vertex)).squaredNorm());
        nearest_m2_ = distances_m2_;
        const auto last = nearest_m2_.begin() + static_cast<std::ptrdiff_t>(most_ - 1);
        std::ranges::nth_element(nearest_m2_, last);
        reach_m2 = *last;
        for (std::uint32_t i = 0; i < distances_m2_.size(); ++i) {
            if (distances_m2_[i] <= reach_m2) allowed_.push_back(i);
        }
    }
    count_[vertex] = static_cast<std::uint32_t>(allowed_.size()) - first_[vertex];
}

}  // namespace conelane
