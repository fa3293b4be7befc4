#pragma once

#include "model/geometry.hpp"

#include <map>
#include <string>
#include <vector>

namespace conelane::experiments {

/// The whole annotated boundaries of a track in driving order, from which the centre line is made and
/// divergence is measured.
struct TrackBoundaries {
    std::vector<Point> left;
    std::vector<Point> right;
    bool closed = true;
    std::vector<Point> driven = {};  ///< the path of a run without annotated boundaries; else empty
};

using TrackBoundariesByName = std::map<std::string, TrackBoundaries>;

}  // namespace conelane::experiments
