#include "graph_search/front/front_weights.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/front/front_features.hpp"
#include "graph_search/shared/weights_reader.hpp"

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

/// Files of version 1 have no features of colors: their weights are 0. Those of version 2 have one set of
/// weights for all scenes, those of version 3 a second one for scenes with colors.
constexpr int kWithoutColors = 1;
constexpr int kOneSet = 2;
constexpr int kTwoSets = 3;

/// Features of a list that are in a file of that version.
std::span<const FrontFeature> features_in(const FrontFeatureList& list, int version) {
    return list.features.first(list.features.size() - (version == kWithoutColors ? list.colors : 0));
}

/// Reads the keys that begin with `prefix`. The weights of inputs that the version does not have stay
/// unchanged.
void read_set(WeightsReader& file, const std::string& prefix, int version, FrontWeightSet& weights) {
    for_each_weights_list(weights, [&](const FrontNetworkPlace& place, const char* list,
                                       std::span<float> numbers, std::size_t each) {
        const std::vector<FrontFeatureList> inputs =
            each > 0 ? input_lists(place) : std::vector<FrontFeatureList>{};
        std::size_t count = each > 0 ? 0 : numbers.size();
        for (const FrontFeatureList& input : inputs) count += each * features_in(input, version).size();
        const std::vector<float> given = file.floats(prefix + std::string(place.key) + "_" + list, count);
        if (each == 0) std::ranges::copy(given, numbers.begin());
        auto from = given.begin();
        auto to = numbers.begin();
        for (const FrontFeatureList& input : inputs) {
            const std::size_t size = each * features_in(input, version).size();
            std::copy_n(from, size, to);
            from += static_cast<std::ptrdiff_t>(size);
            to += static_cast<std::ptrdiff_t>(each * input.features.size());
        }
    });
    weights.least_trust = file.number(prefix + "least_trust");
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

FrontWeights parse_front_weights(std::string_view text) {
    WeightsReader file(text, "weights", "conelane train front");
    const int version = file.version({kWithoutColors, kOneSet, kTwoSets});
    for (const FrontFeatureList& list : front_feature_lists())
        file.require_features("features." + std::string(list.key), features_in(list, version));
    FrontWeights weights = FrontWeights::zero();
    const FrontWeightSet zero = weights;
    read_set(file, "", version, weights);
    if (version == kTwoSets) read_set(file, "colored_", version, weights.colored.emplace(zero));
    file.require_no_other("weights of front");
    validate(weights);
    return weights;
}

FrontWeights read_front_weights(const std::filesystem::path& file) {
    FrontWeights weights;
    with_weights_file(file, [&](std::string_view text) { weights = parse_front_weights(text); });
    return weights;
}

}  // namespace conelane
