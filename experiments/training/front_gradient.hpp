#pragma once

#include "graph_search/front/front_weights.hpp"

#include <cstddef>
#include <functional>
#include <span>

namespace conelane::experiments {

/// Adds `factor` times the derivatives of the network's score for these inputs, with respect to its weights,
/// to `derivatives`, which has the same shape.
void add_derivatives(const FrontNetworkWeights& network, std::span<const float> inputs, float factor,
                     FrontNetworkWeights& derivatives);

/// All numbers of the networks, block by block, always in the same order.
void for_each_block(FrontWeights& weights, const std::function<void(std::span<float>)>& use);
void for_each_block(const FrontWeights& weights, const std::function<void(std::span<const float>)>& use);
/// Their number.
[[nodiscard]] std::size_t parameter_count(const FrontWeights& weights);

/// a += b
void add(FrontWeights& a, const FrontWeights& b);
void set_zero(FrontWeights& weights);

}  // namespace conelane::experiments
