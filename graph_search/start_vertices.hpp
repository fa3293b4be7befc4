#pragma once

#include "graph_search/path_pair_enumeration.hpp"
#include "model/scene.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace conelane {

struct StartVertexRules {
    double radius_m = 2.0;         ///< first search radius around the car
    double radius_growth_m = 1.0;  ///< while fewer pairs than wanted are inside, the radius grows by this ...
    double largest_radius_m = 8.0;  ///< ... up to here
    double distance_weight = 2.0;   ///< see start_pairs
    double w_min_m = 2.5;           ///< a pair not farther apart than this is no start of a feasible lane
    double w_max_m = 6.5;           ///< a pair as far apart as this is none either
};

/// How a pair of start vertices, one on each side of the car, stands to it. The same where the scene is
/// mirrored.
struct StartPairMeasures {
    double asymmetry_m;       ///< between one vertex and the mirror image of the other in the car's axis
    double distance_m;        ///< from the car to the farther vertex
    double lead_m;            ///< of one vertex ahead of the other, along the axis
    double shift_m;           ///< by which one is farther from the axis than the other
    double nearest_side_m;    ///< from the axis to the nearer vertex
    double nearest_ahead_m;   ///< of the vertex that is less far ahead of the car
    double farthest_ahead_m;  ///< of the other one
};
[[nodiscard]] StartPairMeasures start_pair_measures(const Scene& scene, StartPair pair);

struct RankedStartPair {
    StartPair pair;
    double cost_m;
    double distance_m;  ///< as StartPairMeasures
};
/// All pairs of start_pairs within the largest radius, best first.
[[nodiscard]] std::vector<RankedStartPair> ranked_start_pairs(const Scene& scene,
                                                              const StartVertexRules& rules);

/// Pairs to start the search from, best first, at most `count`; section IV-C of the CLC paper. A left vertex
/// has a positive angle with the car's heading, a right one a negative one. The search radius grows until it
/// holds `count` pairs: a lane may start a few metres ahead, and a false positive near the car must not shut
/// out the others. Pairs rank by asymmetry_m + distance_weight * distance_m of their measures. (By asymmetry
/// alone, as printed, any symmetric pair farther ahead would go before the first cones of a lane that do not
/// face each other.) Ties: the pair with the smaller vertices.
[[nodiscard]] std::vector<StartPair> start_pairs(const Scene& scene, std::size_t count,
                                                 const StartVertexRules& rules);
/// The same from ranked_start_pairs of the scene, by the same rules.
[[nodiscard]] std::vector<StartPair> start_pairs(std::span<const RankedStartPair> ranked, std::size_t count,
                                                 const StartVertexRules& rules);

}  // namespace conelane
