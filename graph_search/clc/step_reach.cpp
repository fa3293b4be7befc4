#include "graph_search/clc/step_reach.hpp"

#include <algorithm>
#include <limits>
#include <span>

namespace conelane {

void StepReach::reset(const SearchGraph& graph, std::size_t most) {
    graph_ = &graph;
    most_ = most;
    squared_m2_.assign(graph.vertex_count(), -1.0);
}

double StepReach::find(Vertex vertex) {
    const std::span<const Vertex> neighbours = graph_->neighbours(vertex);
    double& result = squared_m2_[vertex];
    if (most_ == 0 || neighbours.size() <= most_) {
        result = std::numeric_limits<double>::infinity();
        return result;
    }
    distances_m2_.clear();
    for (const Vertex neighbour : neighbours)
        distances_m2_.push_back((graph_->position(neighbour) - graph_->position(vertex)).squaredNorm());
    const auto last = distances_m2_.begin() + static_cast<std::ptrdiff_t>(most_ - 1);
    std::ranges::nth_element(distances_m2_, last);
    result = *last;
    return result;
}

}  // namespace conelane
