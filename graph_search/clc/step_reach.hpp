#pragma once

#include "graph_search/shared/search_graph.hpp"

#include <cstddef>
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
        return squared_m2_[vertex] < 0.0 ? find(vertex) : squared_m2_[vertex];
    }

  private:
    double find(Vertex vertex);

    const SearchGraph* graph_ = nullptr;
    std::size_t most_ = 0;
    std::vector<double> squared_m2_;  ///< by vertex; negative until it is asked for
    std::vector<double> distances_m2_;
};

}  // namespace conelane
