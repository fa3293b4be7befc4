#pragma once

#include "conelane/lane.hpp"
#include "graph_search/front/front_map.hpp"

#include <cstdint>
#include <utility>
#include <vector>

namespace conelane {

/// What the last lane of a lap says about the next scene. A cone that was on a boundary of it, found again by
/// its id, earns a bonus wherever a lane has it on that side. New cones and cones that were left aside earn
/// none, so a lane that was wrong has no more than its cones' bonuses before the right one, and that only
/// while those cones are seen.
///
/// Of the forms compared, a bonus for a segment that is repeated and a memory of several scenes did no better
/// than this one, and one that also charges cones left aside lost overlap.
class FrontEvidence {
  public:
    /// `bonus`: score for each cone, at least 0. Throws InvalidInput where it is not.
    explicit FrontEvidence(double bonus);

    /// Takes a lane in place of what was remembered.
    void remember(const Lane& lane);
    void forget() { remembered_.clear(); }

    /// Finds the cones remembered in a scene, of which `map` was built. Keeps memory from call to call.
    void find_again(const Scene& scene, const FrontMap& map);
    /// The bonus of a cone of that scene on a side.
    [[nodiscard]] double bonus(Side side, Vertex cone) const {
        return (sides_[cone] & bit_of(side)) != 0 ? bonus_ : 0.0;
    }

  private:
    [[nodiscard]] static std::uint8_t bit_of(Side side) { return side == kLeft ? 1 : 2; }

    double bonus_;
    std::vector<std::pair<ConeId, std::uint8_t>> remembered_;  ///< by id
    std::vector<std::uint8_t> sides_;                          ///< of each cone of the map
};

}  // namespace conelane
