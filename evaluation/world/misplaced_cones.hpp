#pragma once

#include "evaluation/world/track.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace conelane {

/// A cone that cannot belong to the boundary of its color.
struct MisplacedCone {
    std::size_t cone = 0;
    std::string reason;
    bool is_same = false;  ///< as another cone, at its place
};

/// Of some cones, those more than 15 m from the largest group: where two of them are nearer, they are of one
/// group.
[[nodiscard]] std::vector<MisplacedCone> far_cones(const std::vector<Cone>& cones,
                                                   std::span<const std::size_t> some);

/// The cones of the second row if a boundary, still unordered, was written twice: nearly half of its cones
/// stand within 0.5 m of an earlier one.
[[nodiscard]] std::vector<MisplacedCone> second_row(const std::vector<Cone>& cones,
                                                    std::span<const std::size_t> boundary);

/// The cone of an ordered boundary that fits it least: it stands in the line of the other boundary, or
/// outside the lane.
[[nodiscard]] std::optional<MisplacedCone> most_misplaced_cone(const Track& track);

}  // namespace conelane
