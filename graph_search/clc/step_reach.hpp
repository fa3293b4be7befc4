#pragma once

#include "graph_search/shared/search_graph.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace conelane {

/// How far a boundary may step from a vertex: to its nearest neighbours only, where cones are dense. Beyond
/// the paper: with steps of up to 10 m a cone may have over 100 neighbours, most of them of other parts of
/// the course. Features still count all neighbours.
class StepReach {
  public:
    /// `most`: neighbours of a vertex that a step may lead to, and those as near as the last one of them; 0:
    /// all. `graph` must outlive the use of this object. Keeps memory from call to call.
    void reset(const SearchGraph& graph, std::size_t most);
    /// Square of the largest length of a step from the vertex, infinity if all neighbours are allowed [m^2].
    [[nodiscard]] double squared_m2(Vertex vertex) {
        if (squared_m2_[vertex] < 0.0) find(vertex);
        return squared_m2_[vertex];
    }
    /// The places of the allowed neighbours among all neighbours of the vertex, ascending. Valid until the
    /// next call.
    [[nodiscard]] std::span<const std::uint32_t> steps(Vertex vertex) {
        if (squared_m2_[vertex] < 0.0) find(vertex);
        return std::span(allowed_).subspan(first_[vertex], count_[vertex]);
    }

  private:
    void find(Vertex vertex);

    const SearchGraph* graph_ = nullptr;
    std::size_t most_ = 0;
    std::vector<double> squared_m2_;    ///< by vertex; negative until it is asked for
    std::vector<std::uint32_t> first_;  ///< by vertex, in `allowed_`
    std::vector<std::uint32_t> count_;  ///< by vertex
    std::vector<std::uint32_t> allowed_;
    std::vector<double> distances_m2_;
    std::vector<double> nearest_m2_;
};

}  // namespace conelane
