#include "evaluation/formats/learned_costs_file.hpp"

#include "conelane/invalid_input.hpp"

#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace conelane {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;

Json feature_names() {
    Json lists = Json::object();
    for (const LearnedPart part : kLearnedParts) {
        Json& names = lists[std::string(to_string(part))] = Json::array();
        for (const LearnedFeature& feature : learned_features(part))
            names.push_back(std::string(feature.name));
    }
    return lists;
}

}  // namespace

std::string learned_costs_json(const LearnedCosts& costs, std::string_view training) {
    validate(costs);
    const Json record = Json::parse(training, nullptr, false);
    if (!record.is_object()) throw InvalidInput("training", "must be a JSON object");
    std::string text = fmt::format("{{\n\"version\": {},\n\"training\": {{", kVersion);
    const char* comma = "\n  ";
    for (const auto& [key, value] : record.items()) {
        text += comma + Json(key).dump() + ": " + value.dump();
        comma = ",\n  ";
    }
    text += "},\n\"features\": " + feature_names().dump();
    for (const LearnedPart part : kLearnedParts) {
        const auto write = [&](const char* list, std::span<const double> values) {
            text += fmt::format(",\n\"{}_{}\": [", to_string(part), list);
            for (std::size_t i = 0; i < values.size(); ++i)
                text += fmt::format("{}{}", i == 0 ? "" : ",", values[i]);
            text += "]";
        };
        write("linear", costs.of(part).linear);
        write("hidden", costs.of(part).hidden);
        write("output", costs.of(part).output);
    }
    return text + "\n}\n";
}

}  // namespace conelane
