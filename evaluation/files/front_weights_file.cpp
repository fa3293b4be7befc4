#include "evaluation/files/front_weights_file.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/front/front_judge_features.hpp"

#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace conelane {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 2;

/// Of all networks, in the order of the file.
Json feature_names() {
    Json lists = Json::object();
    for (const FrontFeatureList& list : front_feature_lists()) {
        Json& names = lists[std::string(list.key)] = Json::array();
        for (const FrontFeature& feature : list.features) names.push_back(std::string(feature.name));
    }
    return lists;
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
