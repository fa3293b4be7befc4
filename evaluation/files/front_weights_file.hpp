#pragma once

#include "graph_search/front/front_cost.hpp"

#include <string>
#include <string_view>

namespace conelane {

/// The weights of `front` from their file: a JSON object with `version` 1, `features`, the names of the
/// inputs as the program has them, and the numbers of the networks, such as `extend_hidden`. `training` says
/// where they come from. Throws InvalidInput naming the key.
[[nodiscard]] FrontWeights parse_front_weights(std::string_view json);

/// The file, such that parse_front_weights gives the same weights to the last bit; a line for each key.
/// `training`: a JSON object. Throws InvalidInput where the weights are not valid or `training` is no JSON.
[[nodiscard]] std::string front_weights_json(const FrontWeights& weights, std::string_view training);

}  // namespace conelane
