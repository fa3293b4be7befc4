#pragma once

#include "graph_search/clc/ranking.hpp"

#include <string>
#include <string_view>

namespace conelane {

/// Weights from their file: a JSON object with `version` 1, `features` (the names of the inputs, which must
/// be the first ones of lane_feature_names), `mean`, `deviation`, `hidden` (an array for each unit),
/// `hidden_bias`, `output` and `output_bias`. Other keys, such as `training`, say where they come from.
/// Throws InvalidInput naming the key.
[[nodiscard]] RankNetWeights parse_rank_net(std::string_view json);

/// The file, such that parse_rank_net gives the same weights to the last bit. `training`: a JSON object.
/// Throws InvalidInput if make_rank_net refuses the weights or `training` is not JSON.
[[nodiscard]] std::string rank_net_json(const RankNetWeights& weights, std::string_view training);

}  // namespace conelane
