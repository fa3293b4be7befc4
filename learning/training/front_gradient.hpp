#pragma once

#include "graph_search/front/front_weights.hpp"

#include <concepts>
#include <cstddef>
#include <span>
#include <type_traits>

namespace conelane::learning {

/// Adds `factor` times the derivatives of the network's score for these inputs, with respect to its weights,
/// to `derivatives`, which has the same shape.
void add_derivatives(const FrontNetworkWeights& network, std::span<const float> inputs, float factor,
                     FrontNetworkWeights& derivatives);

/// Calls `use` with all numbers of the networks, block by block, always in the same order. `weights`: a
/// FrontWeights.
template <typename Weights, typename Use>
requires std::derived_from<std::remove_const_t<Weights>, FrontWeightSet>
void for_each_block(Weights& weights, const Use& use) {
    for_each_weights_list(weights, [&](const FrontNetworkPlace& /*place*/, const char* /*key*/, auto numbers,
                                       std::size_t /*each*/) { use(numbers); });
}

/// a += b
void add(FrontWeights& a, const FrontWeights& b);
void set_zero(FrontWeights& weights);

}  // namespace conelane::learning
