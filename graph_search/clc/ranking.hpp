#pragma once

#include "graph_search/clc/lane_features.hpp"

#include <memory>

#include <Eigen/Core>

namespace conelane {

/// Scores candidate lanes: a higher score means a likelier lane. Stateless, so one object may serve many
/// threads.
class LaneRanking {
  public:
    virtual ~LaneRanking() = default;
    /// Writes one score for each lane.
    virtual void score(std::span<const LaneFeatures> lanes, std::span<double> scores) const = 0;
};

/// Writes the inputs of a network for a lane: its first inputs.size() features, with each pair of sides
/// replaced by the mean and half the distance of its values. So a lane and its mirror image have the same
/// inputs. Precondition: both sides of a pair are included, or neither.
void network_inputs(const LaneFeatures& lane, std::span<double> inputs);

/// The network of section VII: standardised inputs, rectified linear units, one output. The paper has 8
/// inputs and 100 units, 1001 parameters; others are allowed.
struct RankNetWeights {
    Eigen::VectorXd mean;       ///< subtracted from each of network_inputs, ...
    Eigen::VectorXd deviation;  ///< ... which is then divided by this; positive
    Eigen::MatrixXf hidden;     ///< a row for each unit, a column for each input
    Eigen::VectorXf hidden_bias;
    Eigen::VectorXf output;
    float output_bias = 0.0F;
};
/// Throws InvalidInput if sizes do not fit, the number of inputs is neither that of the paper's features nor
/// of all, a number is not finite or a deviation is not positive.
[[nodiscard]] std::shared_ptr<const LaneRanking> make_rank_net(const RankNetWeights& weights);

}  // namespace conelane
