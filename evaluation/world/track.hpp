#pragma once

#include "conelane/scene.hpp"
#include "evaluation/world/track_boundaries.hpp"

#include <string>
#include <vector>

namespace conelane {

/// Position of a cone on the map of one moment.
struct MapPlace {
    std::size_t cone = 0;
    Point position;
};

/// Pose and map of a car at one moment of a recorded run.
struct RunFrame {
    Pose pose;
    double travelled_m = 0.0;
    std::vector<MapPlace> map;
};

/// A map of cones with annotated boundaries. Indices refer to `cones`; cones that belong to no boundary are
/// false positives of the recording and stay visible.
struct Track {
    std::string name;                ///< as scene ids and result tables show it, such as "fsd_1"
    std::vector<Cone> cones;         ///< ids of the source if it has any, else the index
    std::vector<std::size_t> left;   ///< driving order
    std::vector<std::size_t> right;  ///< driving order
    bool closed = true;
    /// Frames of a recorded run, in order; then `cones` are all cones that its maps ever held, at their last
    /// places.
    std::vector<RunFrame> frames{};
    std::vector<Point> driven{};  ///< the path of a run without boundaries
    std::vector<std::string>
        warnings{};  ///< facts about the recording that a user should know, a sentence each
};

/// The annotated boundaries as polylines.
[[nodiscard]] TrackBoundaries boundaries(const Track& track);

}  // namespace conelane
