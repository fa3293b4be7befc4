#pragma once

#include "graph_search/shared/simd_batch.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace conelane {

/// Units of the hidden layer of each network.
inline constexpr std::size_t kFrontUnits = 48;

/// A network of one hidden layer beside a linear part:
/// score = output_bias + linear * x + output * max(0, hidden_bias + hidden * x).
struct FrontNetworkWeights {
    std::size_t inputs = 0;
    std::vector<float> hidden;  ///< kFrontUnits for each input, one input after the other
    std::vector<float> hidden_bias;
    std::vector<float> output;
    std::vector<float> linear;
    float output_bias = 0.0F;

    /// All 0.
    [[nodiscard]] static FrontNetworkWeights zero(std::size_t inputs);
    /// The number of all weights.
    [[nodiscard]] std::size_t size() const { return inputs * (kFrontUnits + 1) + 2 * kFrontUnits + 1; }
    bool operator==(const FrontNetworkWeights&) const = default;
};

/// Throws InvalidInput naming the key, after `prefix`, where a size is wrong or a number not finite.
void validate(const FrontNetworkWeights& weights, std::string_view prefix);

/// The sums of the hidden units and of the linear part over the first inputs, which several moves of one
/// state have in common: they are computed once.
struct FrontSums {
    alignas(32) std::array<float, kFrontUnits> hidden;
    float linear;
};

/// Inference. Sums run in a fixed order, eight units at a time on every processor, so the results are
/// identical to the last bit.
class FrontNetwork {
  public:
    explicit FrontNetwork(FrontNetworkWeights weights) : weights_(std::move(weights)) {}

    [[nodiscard]] const FrontNetworkWeights& weights() const { return weights_; }
    /// The sums over the first inputs.
    void begin(std::span<const float> first_inputs, FrontSums& sums) const;
    /// Adds the inputs from `first` on to `sums` and returns the scores of two moves; `inputs` holds those of
    /// one move after those of the other. The last `unused` inputs of each are 0 and are skipped.
    void score(const FrontSums& sums, std::size_t first, std::span<const float> inputs,
               std::span<float> scores, std::size_t unused = 0) const;
    /// The score of all inputs.
    [[nodiscard]] float score(std::span<const float> inputs) const;

  private:
    FrontNetworkWeights weights_;
};

}  // namespace conelane
