#pragma once

#include "solvers/path_pair/bound/multipliers.hpp"
#include "solvers/path_pair/graph/arc_graph.hpp"
#include "solvers/path_pair/search_clock.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace conelane::path_pair {

/// Finds cliques of incompatible edges whose averaged uses x add up to more than 1. A clique grows greedily
/// from each edge in use, largest x first, then is extended to a maximal clique of the residual graph.
class CliqueSeparation {
  public:
    /// Returns the number of cliques added to the pool, at most `most`; fewer if the clock expires.
    int separate(const ArcGraph& graph, std::span<const double> edge_use, std::span<const char> edge_alive,
                 int most, CliquePool& pool, SearchClock& clock);

  private:
    std::vector<int> used_;
    std::vector<int> clique_;
    std::vector<std::uint64_t> common_;  ///< edges that are incompatible with all edges of the clique
    std::vector<char> covered_;
};

}  // namespace conelane::path_pair
