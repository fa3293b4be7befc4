#pragma once

#include "model/lane.hpp"
#include "model/scene.hpp"

#include <cstdint>
#include <optional>
#include <string>

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

}  // namespace conelane::experiments
