#include "graph_search/clc/ranking.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/shared/simd_batch.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <vector>

namespace conelane {
namespace {

/// Candidates that the network evaluates at once, ...
constexpr std::size_t kBatch = 16;
/// ... and hidden units that it evaluates at once: their sums fit into registers.
constexpr std::size_t kUnits = 4;

/// The first feature of each pair of sides.
constexpr std::array<LaneFeature, 6> kPairs{{kConesLeft, kSegmentLengthVarianceLeft, kTurnVarianceLeft,
                                             kMeanSegmentLengthLeft, kAbsoluteMeanTurnLeft,
                                             kMeanSquaredTurnChangeLeft}};

/// A batch of numbers in registers, for any register width.
using Floats [[gnu::vector_size(32)]] = float;
constexpr std::size_t kFloats = sizeof(Floats) / sizeof(float);
struct Batch {
    Floats part[kBatch / kFloats];  // NOLINT(modernize-avoid-c-arrays): std::array drops the attribute

    void set(std::size_t i, float value) { part[i / kFloats][i % kFloats] = value; }
    [[nodiscard]] float operator[](std::size_t i) const { return part[i / kFloats][i % kFloats]; }
};

/// Adds the contributions of `kUnits` units for a batch. `weights`: kUnits at a time for all inputs.
CONELANE_SIMD void add_units(const Batch* inputs, std::size_t input_count, const float* weights,
                             const float* bias, const float* output, Batch& sums) {
    std::array<Batch, kUnits> units;
    for (Batch& unit : units) unit.part[0] = unit.part[1] = Floats{};
    for (std::size_t i = 0; i < input_count; ++i, weights += kUnits) {
        for (std::size_t unit = 0; unit < kUnits; ++unit) {
            units[unit].part[0] += weights[unit] * inputs[i].part[0];
            units[unit].part[1] += weights[unit] * inputs[i].part[1];
        }
    }
    for (std::size_t unit = 0; unit < kUnits; ++unit) {
        for (std::size_t part = 0; part < 2; ++part) {
            const Floats value = units[unit].part[part] + bias[unit];
            sums.part[part] += output[unit] * (value > 0.0F ? value : Floats{});
        }
    }
}
static_assert(kBatch == 2 * kFloats);

class RankNet final : public LaneRanking {
  public:
    explicit RankNet(const RankNetWeights& weights)
        : mean_(weights.mean.begin(), weights.mean.end()), output_bias_(weights.output_bias) {
        for (const double deviation : weights.deviation) inverse_deviation_.push_back(1.0 / deviation);
        // Units beyond the last one have zero weights.
        const auto units = static_cast<std::size_t>(weights.hidden.rows());
        const auto at = [&](const auto& values, std::size_t unit, auto... column) {
            return unit < units ? values(static_cast<Eigen::Index>(unit), column...) : 0.0F;
        };
        for (std::size_t first = 0; first < units; first += kUnits) {
            for (Eigen::Index input = 0; input < weights.hidden.cols(); ++input) {
                for (std::size_t unit = first; unit < first + kUnits; ++unit) {
                    hidden_.push_back(at(weights.hidden, unit, input));
                }
            }
            for (std::size_t unit = first; unit < first + kUnits; ++unit) {
                hidden_bias_.push_back(at(weights.hidden_bias, unit));
                output_.push_back(at(weights.output, unit));
            }
        }
    }

    void score(std::span<const LaneFeatures> lanes, std::span<double> scores) const override {
        assert(lanes.size() == scores.size());
        std::array<double, kLaneFeatureCount> of_lane{};
        std::array<Batch, kLaneFeatureCount> inputs{};
        const std::size_t input_count = mean_.size();
        for (std::size_t first = 0; first < lanes.size(); first += kBatch) {
            const std::size_t count = std::min(kBatch, lanes.size() - first);
            for (std::size_t i = 0; i < count; ++i) {
                network_inputs(lanes[first + i], {of_lane.data(), input_count});
                for (std::size_t k = 0; k < input_count; ++k) {
                    inputs[k].set(i, static_cast<float>((of_lane[k] - mean_[k]) * inverse_deviation_[k]));
                }
            }
            Batch sums{};
            for (std::size_t unit = 0; unit < output_.size(); unit += kUnits) {
                add_units(inputs.data(), input_count, hidden_.data() + unit * input_count,
                          hidden_bias_.data() + unit, output_.data() + unit, sums);
            }
            for (std::size_t i = 0; i < count; ++i) scores[first + i] = sums[i] + output_bias_;
        }
    }

  private:
    std::vector<double> mean_;
    std::vector<double> inverse_deviation_;
    std::vector<float> hidden_;  ///< groups of kUnits units; in a group by input, then by unit
    std::vector<float> hidden_bias_;
    std::vector<float> output_;
    float output_bias_;
};

}  // namespace

void network_inputs(const LaneFeatures& lane, std::span<double> inputs) {
    assert(inputs.size() <= lane.size());
    std::copy_n(lane.begin(), inputs.size(), inputs.begin());
    for (const LaneFeature left : kPairs) {
        if (left >= inputs.size()) break;
        inputs[left] = (lane[left] + lane[left + kRight]) / 2.0;
        inputs[left + kRight] = std::abs(lane[left] - lane[left + kRight]) / 2.0;
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
