#pragma once

#include "graph_search/path_pair_enumeration.hpp"
#include "model/scene.hpp"

#include <cstddef>
#include <vector>

namespace conelane {

struct StartVertexRules {
    double radius_m = 2.0;         ///< first search radius around the car
    double radius_growth_m = 1.0;  ///< while fewer pairs than wanted are inside, the radius grows by this ...
    double largest_radius_m = 8.0;  ///< ... up to here
    double w_min_m = 2.5;           ///< a pair not farther apart than this is no start of a feasible lane
    double w_max_m = 6.5;           ///< a pair as far apart as this is none either
};

/// Pairs to start the search from, best first, at most `count`; section IV-C of the CLC paper. A left vertex
/// has a positive angle with the car's heading, a right one a negative one. The search radius grows until it
/// holds `count` pairs, so that a lane that starts a few metres ahead is found too, and so that pairs with
/// a false positive near the car do not shut out the others. Pairs rank by their asymmetry: the distance
/// between one vertex and the mirror image of the other in the car's axis. Ties: the pair nearer to the car,
/// then the smaller vertices.
[[nodiscard]] std::vector<StartPair> start_pairs(const Scene& scene, std::size_t count,
                                                 const StartVertexRules& rules);

}  // namespace conelane
