#pragma once

#include "graph_search/front/front_network.hpp"

#include <optional>

namespace conelane {

/// What `front` has learned for one kind of scenes.
struct FrontWeightSet {
    // The score of a lane is the sum over its start and its moves, see FrontCost.
    FrontNetworkWeights extend;
    FrontNetworkWeights stop;
    FrontNetworkWeights start;  ///< of a pair, once as each boundary sees it
    // What is said of the best lanes as a whole, see FrontJudge.
    FrontNetworkWeights rank;    ///< added to the score of a lane
    FrontNetworkWeights usable;  ///< log odds that the best lane is usable
    FrontNetworkWeights right;   ///< log odds that a cone of it is right where all before it are
    /// A lane is trusted as far as it is right by `right`, times `usable`, with this probability. Of lanes
    /// that are not usable, most look right cone by cone.
    double least_trust = 1.0;

    bool operator==(const FrontWeightSet&) const = default;
};

/// All that `front` has learned: a set for scenes without colors, and one for the others.
struct FrontWeights : FrontWeightSet {
    /// Of scenes where a cone has a color. Without it the first set serves all scenes.
    std::optional<FrontWeightSet> colored = {};

    /// All 0, of the right sizes, without a set for colors.
    [[nodiscard]] static FrontWeights zero();
    bool operator==(const FrontWeights&) const = default;
};

/// Throws InvalidInput naming the key; those of the set for colors begin with `colored_`.
void validate(const FrontWeights& weights);

}  // namespace conelane
