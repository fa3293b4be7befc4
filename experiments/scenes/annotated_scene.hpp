#pragma once

#include "model/lane.hpp"
#include "model/scene.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace conelane::experiments {

/// A scene with what only the scoring may see.
struct AnnotatedScene {
    Scene scene;
    std::optional<Lane> ground_truth;
    std::string track;  ///< empty where the scene comes from no track
    std::optional<double> false_positive_rate;
    std::optional<double> range_m;
    std::optional<std::uint64_t> seed;  ///< the base seed
};

/// The whole annotated boundaries of a track in driving order, for the divergence measure.
struct TrackBoundaries {
    std::vector<Point> left;
    std::vector<Point> right;
    bool closed = true;
};

/// The companion of a scenes file, by track name.
using TrackBoundariesByName = std::map<std::string, TrackBoundaries>;

}  // namespace conelane::experiments
