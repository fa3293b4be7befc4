#pragma once

#include "graph_search/weights/shipped_weights.hpp"
#include "model/strip_costs.hpp"

namespace conelane {

// Files of weights, a line for each key. Their readers give the same weights to the last bit: see
// parse_front_weights, parse_learned_costs, parse_strip_costs, parse_rank_net and parse_step_scores.
// `training`: a JSON object. Throw InvalidInput if the weights are invalid or `training` is not JSON.
[[nodiscard]] std::string front_weights_json(const FrontWeights& weights, std::string_view training);
[[nodiscard]] std::string learned_costs_json(const LearnedCosts& costs, std::string_view training);
[[nodiscard]] std::string strip_costs_json(const StripCosts& costs, std::string_view training);
[[nodiscard]] std::string rank_net_json(const RankNetWeights& weights, std::string_view training);
[[nodiscard]] std::string step_scores_json(const StepScores& scores, std::string_view training);

}  // namespace conelane
