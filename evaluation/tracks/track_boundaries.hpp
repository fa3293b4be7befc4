#pragma once

#include "model/geometry.hpp"

#include <map>
#include <string>
#include <vector>

namespace conelane {

/// The whole annotated boundaries of a track in driving order, from which the centre line is made and
/// divergence is measured.
struct TrackBoundaries {
    std::vector<Point> left;
    std::vector<Point> right;
    bool closed = true;
    /// The path that was driven, where a run has no annotated boundaries; these are empty then.
    std::vector<Point> driven = {};
};

using TrackBoundariesByName = std::map<std::string, TrackBoundaries>;

}  // namespace conelane
