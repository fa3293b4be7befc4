#include "evaluation/files/front_weights_file.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/front/front_judge_features.hpp"

#include <cstdint>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace conelane {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;

const Json& member(const Json& object, const std::string& key) {
    const auto found = object.find(key);
    if (found == object.end()) throw InvalidInput(key, "is missing");
    return *found;
}

/// Of all networks, in the order of the file.
Json feature_names() {
    const auto names = [](auto table) {
        Json list = Json::array();
        for (const FrontFeature& feature : table) list.push_back(std::string(feature.name));
        return list;
    };
    return {{"state", names(state_feature_table())}, {"extend", names(extend_feature_table())},
            {"stop", names(stop_feature_table())},   {"start", names(start_feature_table())},
            {"cone", names(cone_feature_table())},   {"lane", names(whole_lane_feature_table())}};
}

std::vector<float> numbers(const Json& file, const std::string& key, std::size_t size) {
    const Json& list = member(file, key);
    if (!list.is_array() || list.size() != size) {
        throw InvalidInput(key, fmt::format("must be an array of {} numbers", size));
    }
    std::vector<float> result;
    for (std::size_t i = 0; i < size; ++i) {
        if (!list[i].is_number()) throw InvalidInput(fmt::format("{}[{}]", key, i), "must be a number");
        result.push_back(list[i].get<float>());
    }
    return result;
}

template <typename Weights, typename Use>
void for_each_network(Weights& weights, const Use& use) {
    use("extend", weights.extend);
    use("stop", weights.stop);
    use("start", weights.start);
    use("rank", weights.rank);
    use("usable", weights.usable);
    use("right", weights.right);
}

}  // namespace

FrontWeights parse_front_weights(std::string_view json) {
    const Json file = Json::parse(json, nullptr, false);
    if (!file.is_object()) throw InvalidInput("weights", "must be a JSON object");
    const Json& version = member(file, "version");
    if (!version.is_number_integer() || version.get<std::int64_t>() != kVersion) {
        throw InvalidInput("version", "must be " + std::to_string(kVersion));
    }
    if (member(file, "features") != feature_names())
        throw InvalidInput("features", "are not those of the program");
    FrontWeights weights = FrontWeights::zero();
    for_each_network(weights, [&](const std::string& name, FrontNetworkWeights& network) {
        network.hidden = numbers(file, name + "_hidden", network.hidden.size());
        network.hidden_bias = numbers(file, name + "_hidden_bias", network.hidden_bias.size());
        network.output = numbers(file, name + "_output", network.output.size());
        network.linear = numbers(file, name + "_linear", network.linear.size());
        network.output_bias = numbers(file, name + "_output_bias", 1).front();
    });
    const Json& least_trust = member(file, "least_trust");
    if (!least_trust.is_number()) throw InvalidInput("least_trust", "must be a number");
    weights.least_trust = least_trust.get<double>();
    validate(weights);
    return weights;
}

std::string front_weights_json(const FrontWeights& weights, std::string_view training) {
    validate(weights);
    const Json record = Json::parse(training, nullptr, false);
    if (!record.is_object()) throw InvalidInput("training", "must be a JSON object");
    std::string text = fmt::format("{{\n\"version\": {},\n\"training\": {{", kVersion);
    const char* comma = "\n  ";
    for (const auto& [key, value] : record.items()) {
        text += comma + Json(key).dump() + ": " + value.dump();
        comma = ",\n  ";
    }
    text += "},\n\"features\": " + feature_names().dump();
    const auto write = [&](const std::string& key, std::span<const float> values) {
        text += fmt::format(",\n\"{}\": [", key);
        for (std::size_t i = 0; i < values.size(); ++i)
            text += fmt::format("{}{}", i == 0 ? "" : ",", values[i]);
        text += "]";
    };
    for_each_network(weights, [&](const std::string& name, const FrontNetworkWeights& network) {
        write(name + "_hidden", network.hidden);
        write(name + "_hidden_bias", network.hidden_bias);
        write(name + "_output", network.output);
        write(name + "_linear", network.linear);
        write(name + "_output_bias", std::span(&network.output_bias, 1));
    });
    return text + fmt::format(",\n\"least_trust\": {}\n}}\n", weights.least_trust);
}

}  // namespace conelane
