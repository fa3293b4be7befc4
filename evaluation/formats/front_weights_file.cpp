#include "evaluation/formats/front_weights_file.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/front/front_judge_features.hpp"

#include <array>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace conelane {
namespace {

using Json = nlohmann::ordered_json;

/// With a set of weights for colors and without one.
constexpr int kTwoSets = 3;
constexpr int kOneSet = 2;

/// Of all networks, in the order of the file.
Json feature_names() {
    Json lists = Json::object();
    for (const FrontFeatureList& list : front_feature_lists()) {
        Json& names = lists[std::string(list.key)] = Json::array();
        for (const FrontFeature& feature : list.features) names.push_back(std::string(feature.name));
    }
    return lists;
}

void write(const std::string& key, std::span<const float> values, std::string& text) {
    text += fmt::format(",\n\"{}\": [", key);
    for (std::size_t i = 0; i < values.size(); ++i) text += fmt::format("{}{}", i == 0 ? "" : ",", values[i]);
    text += "]";
}

void write(const std::string& prefix, const FrontWeightSet& weights, std::string& text) {
    const std::array<std::pair<const char*, const FrontNetworkWeights*>, 6> networks{
        {{"extend", &weights.extend},
         {"stop", &weights.stop},
         {"start", &weights.start},
         {"rank", &weights.rank},
         {"usable", &weights.usable},
         {"right", &weights.right}}};
    for (const auto& [of, network] : networks) {
        const std::string name = prefix + of;
        write(name + "_hidden", network->hidden, text);
        write(name + "_hidden_bias", network->hidden_bias, text);
        write(name + "_output", network->output, text);
        write(name + "_linear", network->linear, text);
        write(name + "_output_bias", std::span(&network->output_bias, 1), text);
    }
    text += fmt::format(",\n\"{}least_trust\": {}", prefix, weights.least_trust);
}

}  // namespace

std::string front_weights_json(const FrontWeights& weights, std::string_view training) {
    validate(weights);
    const Json record = Json::parse(training, nullptr, false);
    if (!record.is_object()) throw InvalidInput("training", "must be a JSON object");
    std::string text =
        fmt::format("{{\n\"version\": {},\n\"training\": {{", weights.colored ? kTwoSets : kOneSet);
    const char* comma = "\n  ";
    for (const auto& [key, value] : record.items()) {
        text += comma + Json(key).dump() + ": " + value.dump();
        comma = ",\n  ";
    }
    text += "},\n\"features\": " + feature_names().dump();
    write("", weights, text);
    if (weights.colored) write("colored_", *weights.colored, text);
    return text + "\n}\n";
}

}  // namespace conelane
