#include "graph_search/front/front_weights.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/front/front_judge_features.hpp"

#include <algorithm>
#include <string>

namespace conelane {

namespace {

std::size_t inputs_of(const FrontNetworkPlace& place) {
    std::size_t inputs = 0;
    for (const FrontFeatureList& list : input_lists(place)) inputs += list.features.size();
    return inputs;
}

void validate_set(const FrontWeightSet& weights, const std::string& prefix) {
    for (const FrontNetworkPlace& place : kFrontNetworks) {
        const std::string name = prefix + std::string(place.key);
        if ((weights.*place.network).inputs != inputs_of(place))
            throw InvalidInput(name + ".inputs", "must be " + std::to_string(inputs_of(place)));
        validate(weights.*place.network, name);
    }
    if (!(weights.least_trust >= 0.0 && weights.least_trust <= 1.0))
        throw InvalidInput(prefix + "least_trust", "must be in [0, 1]");
}

}  // namespace

std::vector<FrontFeatureList> input_lists(const FrontNetworkPlace& place) {
    const auto all = front_feature_lists();
    std::vector<FrontFeatureList> lists;
    for (const std::string_view key : place.inputs) {
        if (!key.empty()) lists.push_back(*std::ranges::find(all, key, &FrontFeatureList::key));
    }
    return lists;
}

FrontWeights FrontWeights::zero() {
    FrontWeights weights;
    for (const FrontNetworkPlace& place : kFrontNetworks)
        weights.*place.network = FrontNetworkWeights::zero(inputs_of(place));
    return weights;
}

void validate(const FrontWeights& weights) {
    validate_set(weights, "");
    if (weights.colored) validate_set(*weights.colored, "colored_");
}

}  // namespace conelane
