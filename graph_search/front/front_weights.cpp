#include "graph_search/front/front_weights.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/front/front_features.hpp"
#include "graph_search/front/front_judge_features.hpp"

#include <string>

namespace conelane {

FrontWeights FrontWeights::zero() {
    return {FrontNetworkWeights::zero(kExtendInputs),      FrontNetworkWeights::zero(kStopInputs),
            FrontNetworkWeights::zero(kStartFeatures),     FrontNetworkWeights::zero(kWholeLaneFeatures),
            FrontNetworkWeights::zero(kWholeLaneFeatures), FrontNetworkWeights::zero(kRightInputs)};
}

void validate(const FrontWeights& weights) {
    const auto require = [](const FrontNetworkWeights& network, std::size_t inputs, const char* name) {
        if (network.inputs != inputs) {
            throw InvalidInput(std::string(name) + ".inputs", "must be " + std::to_string(inputs));
        }
        validate(network, name);
    };
    require(weights.extend, kExtendInputs, "extend");
    require(weights.stop, kStopInputs, "stop");
    require(weights.start, kStartFeatures, "start");
    require(weights.rank, kWholeLaneFeatures, "rank");
    require(weights.usable, kWholeLaneFeatures, "usable");
    require(weights.right, kRightInputs, "right");
    if (!(weights.least_trust >= 0.0 && weights.least_trust <= 1.0))
        throw InvalidInput("least_trust", "must be in [0, 1]");
}

}  // namespace conelane
