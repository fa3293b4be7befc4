#pragma once

#include "graph_search/front/front_features.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

namespace conelane {

// What FrontJudge sees of the best lanes of a search, its contenders. Their probabilities are the softmax of
// their scores.

/// Of a cone of a lane, before what FrontCost saw of the move that added it (0 for the first pair).
inline constexpr std::size_t kConeFeatures = 8;
/// Of a whole lane.
inline constexpr std::size_t kWholeLaneColorFeatures = 4;  ///< the last ones
inline constexpr std::size_t kWholeLaneFeatures = 30 + kWholeLaneColorFeatures;
inline constexpr std::size_t kRightInputs = kConeFeatures + kExtendInputs;

[[nodiscard]] std::span<const FrontFeature, kConeFeatures> cone_feature_table();
[[nodiscard]] std::span<const FrontFeature, kWholeLaneFeatures> whole_lane_feature_table();

/// All tables under the keys that files of weights have for them, in the order of those files.
struct FrontFeatureList {
    std::string_view key;
    std::span<const FrontFeature> features;
    std::size_t colors;  ///< how many at their end are of colors
};
[[nodiscard]] std::array<FrontFeatureList, 6> front_feature_lists();

using RightInputs = std::array<float, kRightInputs>;
using WholeLaneFeatures = std::array<float, kWholeLaneFeatures>;

}  // namespace conelane
