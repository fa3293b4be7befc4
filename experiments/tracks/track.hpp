#pragma once

#include "experiments/tracks/track_boundaries.hpp"
#include "model/scene.hpp"

#include <string>
#include <vector>

namespace conelane::experiments {

/// A map of cones with annotated boundaries. Indices refer to `cones`; cones that belong to no boundary are
/// false positives of the recording and stay visible.
struct Track {
    std::string name;                ///< as scene ids and result tables show it, such as "fsd_1"
    std::vector<Cone> cones;         ///< ids are those of the source where it has any, else the index
    std::vector<std::size_t> left;   ///< driving order
    std::vector<std::size_t> right;  ///< driving order
    bool closed = true;
};

/// The annotated boundaries as polylines.
[[nodiscard]] TrackBoundaries boundaries(const Track& track);

}  // namespace conelane::experiments
