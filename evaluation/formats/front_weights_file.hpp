#pragma once

#include "graph_search/front/front_weights_reader.hpp"

#include <string>
#include <string_view>

namespace conelane {

using conelane::parse_front_weights;

/// The file, such that parse_front_weights gives the same weights to the last bit; a line for each key.
/// `training`: a JSON object. Throws InvalidInput if the weights are invalid or `training` is not JSON.
[[nodiscard]] std::string front_weights_json(const FrontWeights& weights, std::string_view training);

}  // namespace conelane
