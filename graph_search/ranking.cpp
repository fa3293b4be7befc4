#include "graph_search/ranking.hpp"

#include "model/invalid_input.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

namespace conelane {
namespace {

/// Candidates that go through the network at once, so that what is between the layers stays in the cache.
constexpr Eigen::Index kBatch = 64;

/// First of each pair of sides.
constexpr std::array<std::size_t, 6> kPairs{1, 4, 6, 21, 23, 25};

class RankNet final : public LaneRanking {
  public:
    explicit RankNet(RankNetWeights weights) : weights_(std::move(weights)) {}

    void score(std::span<const LaneFeatures> lanes, std::span<double> scores) const override {
        assert(lanes.size() == scores.size());
        const Eigen::Index input_count = weights_.hidden.cols();
        Eigen::VectorXd lane_inputs(input_count);
        Eigen::MatrixXf inputs(input_count, kBatch);
        Eigen::MatrixXf units(weights_.hidden.rows(), kBatch);
        const auto count = static_cast<Eigen::Index>(lanes.size());
        for (Eigen::Index first = 0; first < count; first += kBatch) {
            const Eigen::Index batch = std::min(kBatch, count - first);
            for (Eigen::Index i = 0; i < batch; ++i) {
                network_inputs(lanes[static_cast<std::size_t>(first + i)],
                               {lane_inputs.data(), static_cast<std::size_t>(input_count)});
                inputs.col(i) =
                    ((lane_inputs - weights_.mean).array() / weights_.deviation.array()).cast<float>();
            }
            units.leftCols(batch).noalias() = weights_.hidden * inputs.leftCols(batch);
            units.leftCols(batch).colwise() += weights_.hidden_bias;
            for (Eigen::Index i = 0; i < batch; ++i) {
                scores[static_cast<std::size_t>(first + i)] =
                    weights_.output.dot(units.col(i).cwiseMax(0.0F)) + weights_.output_bias;
            }
        }
    }

  private:
    RankNetWeights weights_;
};

}  // namespace

void network_inputs(const LaneFeatures& lane, std::span<double> inputs) {
    assert(inputs.size() <= lane.size());
    std::copy_n(lane.begin(), inputs.size(), inputs.begin());
    for (const std::size_t left : kPairs) {
        if (left >= inputs.size()) break;
        inputs[left] = (lane[left] + lane[left + 1]) / 2.0;
        inputs[left + 1] = std::abs(lane[left] - lane[left + 1]) / 2.0;
    }
}

std::shared_ptr<const LaneRanking> make_rank_net(const RankNetWeights& weights) {
    const auto require = [](bool valid, const char* key, const char* reason) {
        if (!valid) throw InvalidInput(key, reason);
    };
    const Eigen::Index inputs = weights.mean.size();
    require(inputs == kPaperFeatureCount || inputs == kLaneFeatureCount, "mean",
            "must have one entry for each of the paper's features or of all");
    require(weights.deviation.size() == inputs, "deviation", "must have as many entries as mean");
    require(weights.hidden.rows() > 0, "hidden", "must have at least one unit");
    require(weights.hidden.cols() == inputs, "hidden", "must have one column for each entry of mean");
    require(weights.hidden_bias.size() == weights.hidden.rows(), "hidden_bias", "must have one entry a unit");
    require(weights.output.size() == weights.hidden.rows(), "output", "must have one entry a unit");
    require(weights.hidden.allFinite(), "hidden", "must be finite");
    require(weights.hidden_bias.allFinite(), "hidden_bias", "must be finite");
    require(weights.output.allFinite(), "output", "must be finite");
    require(std::isfinite(weights.output_bias), "output_bias", "must be finite");
    require(weights.mean.allFinite(), "mean", "must be finite");
    require(weights.deviation.allFinite() && weights.deviation.minCoeff() > 0.0, "deviation",
            "must be positive");
    return std::make_shared<RankNet>(weights);
}

}  // namespace conelane
