#include "learning/training/front_gradient.hpp"

#include "graph_search/shared/simd_batch.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace conelane::learning {
namespace {

using Units = std::array<float, kFrontUnits>;

CONELANE_SIMD void add_scaled(float factor, const float* from, float* to) {
    for (std::size_t unit = 0; unit < kFrontUnits; ++unit) to[unit] += factor * from[unit];
}

}  // namespace

void add_derivatives(const FrontNetworkWeights& network, std::span<const float> inputs, float factor,
                     FrontNetworkWeights& derivatives) {
    Units sums{};
    std::ranges::copy(network.hidden_bias, sums.begin());
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        if (inputs[i] != 0.0F) add_scaled(inputs[i], network.hidden.data() + i * kFrontUnits, sums.data());
    }
    Units by_sum{};
    for (std::size_t unit = 0; unit < kFrontUnits; ++unit) {
        if (sums[unit] <= 0.0F) continue;
        derivatives.output[unit] += factor * sums[unit];
        by_sum[unit] = factor * network.output[unit];
    }
    add_scaled(1.0F, by_sum.data(), derivatives.hidden_bias.data());
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        if (inputs[i] == 0.0F) continue;
        add_scaled(inputs[i], by_sum.data(), derivatives.hidden.data() + i * kFrontUnits);
        derivatives.linear[i] += factor * inputs[i];
    }
    derivatives.output_bias += factor;
}

void add(FrontWeights& a, const FrontWeights& b) {
    std::vector<std::span<const float>> blocks;
    for_each_block(b, [&](std::span<const float> block) { blocks.push_back(block); });
    auto from = blocks.begin();
    for_each_block(a, [&](std::span<float> block) {
        for (std::size_t i = 0; i < block.size(); ++i) block[i] += (*from)[i];
        ++from;
    });
}

void set_zero(FrontWeights& weights) {
    for_each_block(weights, [](std::span<float> block) { std::ranges::fill(block, 0.0F); });
}

}  // namespace conelane::learning
