#pragma once

#include "solvers/path_pair/bound/pair_relaxation.hpp"
#include "solvers/path_pair/graph/residual_graph.hpp"

#include <vector>

namespace conelane::path_pair {

/// Reduced-cost fixing: arcs and turns whose bound reaches a limit are in no better pair of legs.
class ArcFixing {
  public:
    /// Drops them from the graph. Returns false, without a change, if they are less than a tenth of it: then
    /// renumbering does not pay. `limit`: with offset. Precondition: forward and backward labels are
    /// evaluated on the graph.
    bool drop(const PairRelaxation& relaxation, double limit, ResidualGraph& graph);

  private:
    std::vector<int> order_;
    std::vector<char> keep_successor_;
    std::vector<int> index_;
    ResidualGraph spare_;
};

}  // namespace conelane::path_pair
