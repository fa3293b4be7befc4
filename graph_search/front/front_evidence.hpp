#pragma once

#include "conelane/lane.hpp"
#include "graph_search/front/front_map.hpp"

#include <cstdint>
#include <utility>
#include <vector>

namespace conelane {

/// Evidence from the last lane of a lap for the next scene. A cone that was on a boundary, found again by its
/// id, earns a bonus wherever a lane has it on that side. New cones and cones that were left aside earn none.
/// So a wrong lane has only the bonuses of its cones over the right one, and only while those cones are seen.
///
/// Other forms were no better: a bonus for a repeated segment, a memory of several scenes, and a charge for
/// cones left aside, which lost overlap.
class FrontEvidence {
  public:
    /// `bonus`: score for each cone, at least 0. Throws InvalidInput if it is not.
    explicit FrontEvidence(double bonus);

    /// Replaces the remembered lane.
    void remember(const Lane& lane);
    void forget() { remembered_.clear(); }

    /// Finds the remembered cones in a scene, from which `map` was built. Keeps memory from call to call.
    void find_again(const Scene& scene, const FrontMap& map);
    /// The bonus of a cone of that scene on a side.
    [[nodiscard]] double bonus(Side side, Vertex cone) const {
        return (sides_[cone] & bit_of(side)) != 0 ? bonus_ : 0.0;
    }

  private:
    [[nodiscard]] static std::uint8_t bit_of(Side side) { return side == kLeft ? 1 : 2; }

    double bonus_;
    std::vector<std::pair<ConeId, std::uint8_t>> remembered_;  ///< by id
    std::vector<std::uint8_t> sides_;                          ///< by cone of the map: a bit for each side
};

}  // namespace conelane
