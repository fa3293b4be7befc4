#pragma once

#include "model/geometry.hpp"

#include <map>
#include <string>
#include <vector>

namespace conelane {

/// The whole annotated boundaries of a track in driving order, for the centre line and for divergence.
struct TrackBoundaries {
    std::vector<Point> left;
    std::vector<Point> right;
    bool closed = true;
    /// The driven path of a run without annotated boundaries, which are then empty.
    std::vector<Point> driven = {};
};

using TrackBoundariesByName = std::map<std::string, TrackBoundaries>;

}  // namespace conelane
