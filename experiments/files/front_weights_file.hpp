#pragma once

#include "graph_search/front/front_weights_reader.hpp"

#include <string>
#include <string_view>

namespace conelane::experiments {

using conelane::parse_front_weights;

/// The file, such that parse_front_weights gives the same weights to the last bit; a line for each key.
/// `training`: a JSON object. Throws InvalidInput where the weights are not valid or `training` is no JSON.
[[nodiscard]] std::string front_weights_json(const FrontWeights& weights, std::string_view training);

}  // namespace conelane::experiments
