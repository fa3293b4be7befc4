#pragma once

#include "graph_search/front/front_network.hpp"

namespace conelane {

/// All that `front` has learned.
struct FrontWeights {
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

    /// All 0, of the right sizes.
    [[nodiscard]] static FrontWeights zero();
    bool operator==(const FrontWeights&) const = default;
};

/// Throws InvalidInput naming the key.
void validate(const FrontWeights& weights);

}  // namespace conelane
