#pragma once

#include "conelane/scene.hpp"
#include "graph_search/clc/path_pair_enumeration.hpp"

namespace conelane {

struct StartVertexRules {
    double radius_m = 2.0;          ///< first search radius around the car
    double radius_growth_m = 1.0;   ///< if fewer pairs than wanted are inside, the radius grows by this ...
    double largest_radius_m = 8.0;  ///< ... up to this radius
    double distance_weight = 2.0;   ///< see StartPairs
};

/// Measures of a pair of start vertices, one on each side of the car. They do not change if the scene is
/// mirrored.
struct StartPairMeasures {
    double asymmetry_m;       ///< between one vertex and the mirror image of the other in the car's axis
    double distance_m;        ///< from the car to the farther vertex
    double lead_m;            ///< of one vertex ahead of the other, along the axis
    double shift_m;           ///< difference of the distances from the axis
    double nearest_side_m;    ///< from the axis to the nearer vertex
    double nearest_ahead_m;   ///< of the vertex less far ahead of the car
    double farthest_ahead_m;  ///< of the vertex farther ahead
};
[[nodiscard]] StartPairMeasures start_pair_measures(const Scene& scene, StartPair pair);

struct RankedStartPair {
    StartPair pair;
    double cost_m;
    double distance_m;  ///< as StartPairMeasures
};

/// Pairs to start the search from; section IV-C of the CLC paper. A left vertex has a positive angle with the
/// car's heading, a right one a negative one; their distance is between w_min and w_max. The search radius
/// grows until it holds as many pairs as wanted: a lane may start a few metres ahead, and a false positive
/// near the car must not hide the others. Pairs are ranked by asymmetry_m + distance_weight * distance_m. (By
/// asymmetry alone, as printed, any symmetric pair farther ahead would come before first cones of a lane that
/// do not face each other.) Ties: the pair with the smaller vertices.
class StartPairs {
  public:
    /// Only this many vertices of each side are considered, the nearest to the car: this bounds time and
    /// memory for any number of cones around the car.
    static constexpr std::size_t kMaxVertices = 128;

    /// Finds all pairs within the largest radius. Keeps memory from call to call.
    void find(const Scene& scene, const StartVertexRules& rules, const LaneBounds& bounds);

    /// Best first.
    [[nodiscard]] std::span<const RankedStartPair> ranked() const { return ranked_; }
    /// Whether all vertices were considered.
    [[nodiscard]] bool complete() const { return complete_; }
    /// Sets `pairs` to the best `count`, or to all if there are fewer.
    void best(std::size_t count, std::vector<StartPair>& pairs) const;

  private:
    struct Candidate {
        Vertex vertex;
        double distance_m;
        double ahead_m;
        double left_m;
    };
    void find_candidates(const Scene& scene);

    StartVertexRules rules_;
    std::array<std::vector<Candidate>, 2> candidates_;  ///< by side, those within the largest radius
    std::vector<RankedStartPair> ranked_;
    bool complete_ = true;
};

/// At most `count` pairs, best first.
[[nodiscard]] std::vector<StartPair> start_pairs(const Scene& scene, std::size_t count,
                                                 const StartVertexRules& rules,
                                                 const LaneBounds& bounds = {});

}  // namespace conelane
