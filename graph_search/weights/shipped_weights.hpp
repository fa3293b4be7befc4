#pragma once

#include "graph_search/clc/lane_beam.hpp"
#include "graph_search/clc/ranking.hpp"
#include "graph_search/front/front_cost.hpp"

namespace conelane {

/// The weights of a ranking network from their file: a JSON object with `version` 1, `features` (the names of
/// the inputs, which must be the first ones of lane_feature_names), `mean`, `deviation`, `hidden` (a list for
/// each unit), `hidden_bias`, `output` and `output_bias`. Other keys, such as `training`, say where they come
/// from. Throws InvalidInput naming the key.
[[nodiscard]] RankNetWeights parse_rank_net(std::string_view text);

/// Step scores from their file: a JSON object with `version` 1 and `measures`, which has an object for each
/// of step_measures(): `first` and `spacing`, as the program has them, and `scores`. Throws as
/// parse_rank_net.
[[nodiscard]] StepScores parse_step_scores(std::string_view text);
/// The `training` of such a file, as JSON.
[[nodiscard]] std::string step_scores_training(std::string_view text);

/// The networks of the library: for the paper's features and for all features. Their files in weights/ name
/// the training.
[[nodiscard]] RankNetWeights paper_rank_net_weights();
[[nodiscard]] RankNetWeights extended_rank_net_weights();
[[nodiscard]] std::shared_ptr<const LaneRanking> paper_rank_net();
[[nodiscard]] std::shared_ptr<const LaneRanking> extended_rank_net();

/// The scores for LaneBeam that come with the library.
[[nodiscard]] std::shared_ptr<const StepScores> shipped_step_scores();

/// The weights of `front` that come with the library.
[[nodiscard]] FrontWeights shipped_front_weights();

}  // namespace conelane
