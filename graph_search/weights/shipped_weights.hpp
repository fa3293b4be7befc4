#pragma once

#include "graph_search/clc/lane_beam.hpp"
#include "graph_search/clc/ranking.hpp"
#include "graph_search/front/front_cost.hpp"

#include <memory>

namespace conelane {

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
