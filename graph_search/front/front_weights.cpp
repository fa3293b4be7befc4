#include "graph_search/front/front_weights.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/front/front_features.hpp"
#include "graph_search/front/front_judge_features.hpp"

#include <string>

namespace conelane {

namespace {

void validate_set(const FrontWeightSet& weights, const std::string& prefix) {
    const auto require = [&](const FrontNetworkWeights& network, std::size_t inputs, const char* of) {
        const std::string name = prefix + of;
        if (network.inputs != inputs)
            throw InvalidInput(name + ".inputs", "must be " + std::to_string(inputs));
        validate(network, name);
    };
    require(weights.extend, kExtendInputs, "extend");
    require(weights.stop, kStopInputs, "stop");
    require(weights.start, kStartFeatures, "start");
    require(weights.rank, kWholeLaneFeatures, "rank");
    require(weights.usable, kWholeLaneFeatures, "usable");
    require(weights.right, kRightInputs, "right");
    if (!(weights.least_trust >= 0.0 && weights.least_trust <= 1.0))
        throw InvalidInput(prefix + "least_trust", "must be in [0, 1]");
}

}  // namespace

FrontWeights FrontWeights::zero() {
    FrontWeights weights;
    weights.extend = FrontNetworkWeights::zero(kExtendInputs);
    weights.stop = FrontNetworkWeights::zero(kStopInputs);
    weights.start = FrontNetworkWeights::zero(kStartFeatures);
    weights.rank = FrontNetworkWeights::zero(kWholeLaneFeatures);
    weights.usable = FrontNetworkWeights::zero(kWholeLaneFeatures);
    weights.right = FrontNetworkWeights::zero(kRightInputs);
    return weights;
}

void validate(const FrontWeights& weights) {
    validate_set(weights, "");
    if (weights.colored) validate_set(*weights.colored, "colored_");
}

}  // namespace conelane
