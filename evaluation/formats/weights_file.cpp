#include "evaluation/formats/weights_file.hpp"

#include "conelane/invalid_input.hpp"
#include "detectors/parameters/learned_costs_reader.hpp"

#include <charconv>
#include <cstdlib>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace conelane {
namespace {

using Json = nlohmann::ordered_json;

/// A line for each member or element.
std::string in_lines(const Json& json) {
    std::string text;
    for (const auto& [key, value] : json.items()) {
        text += text.empty() ? "\n  " : ",\n  ";
        if (json.is_object()) text += Json(key).dump() + ": ";
        text += value.dump();
    }
    return json.is_object() ? "{" + text + "}" : "[" + text + "]";
}

/// A file that is written key by key.
class WeightsText {
  public:
    WeightsText(int version, std::string_view training) {
        const Json record = Json::parse(training, nullptr, false);
        if (!record.is_object()) throw InvalidInput("training", "must be a JSON object");
        add("version", fmt::format("{}", version));
        add("training", in_lines(record));
    }
    void add(const std::string& key, const std::string& json) {
        text_ += fmt::format("{}\n\"{}\": {}", text_.empty() ? "{" : ",", key, json);
    }
    template <typename Numbers>
    void add_list(const std::string& key, const Numbers& numbers) {
        add(key, fmt::format("[{}]", fmt::join(numbers, ",")));
    }
    [[nodiscard]] std::string text() const { return text_ + "\n}\n"; }

  private:
    std::string text_;
};

template <typename Features>
Json names_of(const Features& features) {
    Json names = Json::array();
    for (const auto& feature : features) names.push_back(std::string(feature.name));
    return names;
}

void add_set(const std::string& prefix, const FrontWeightSet& weights, WeightsText& file) {
    for_each_weights_list(weights, [&](const FrontNetworkPlace& place, const char* list,
                                       std::span<const float> numbers, std::size_t /*each*/) {
        file.add_list(prefix + std::string(place.key) + "_" + list, numbers);
    });
    file.add(prefix + "least_trust", fmt::format("{}", weights.least_trust));
}

/// The double nearest to the shortest decimal that reads back as the float `value`: this keeps files short.
double shortest(float value) {
    std::array<char, 32> text{};
    const auto [end, error] = std::to_chars(text.data(), text.data() + text.size() - 1, value);
    *end = '\0';
    return std::strtod(text.data(), nullptr);
}

template <typename Values>
Json floats(const Values& values) {
    Json result = Json::array();
    for (Eigen::Index i = 0; i < values.size(); ++i) result.push_back(shortest(values(i)));
    return result;
}

template <typename Costs>
std::string costs_json(const Costs& costs, std::string_view training) {
    validate(costs);
    WeightsText file(1, training);
    Json names = Json::object();
    for (const auto part : Costs::kParts)
        names[std::string(to_string(part))] = names_of(learned_features(part));
    file.add("features", names.dump());
    for_each_costs_list(costs, [&](const std::string& key, const std::vector<double>& numbers) {
        file.add_list(key, numbers);
    });
    return file.text();
}

}  // namespace

std::string front_weights_json(const FrontWeights& weights, std::string_view training) {
    validate(weights);
    WeightsText file(weights.colored ? 3 : 2, training);
    Json names = Json::object();
    for (const FrontFeatureList& list : front_feature_lists())
        names[std::string(list.key)] = names_of(list.features);
    file.add("features", names.dump());
    add_set("", weights, file);
    if (weights.colored) add_set("colored_", *weights.colored, file);
    return file.text();
}

std::string learned_costs_json(const LearnedCosts& costs, std::string_view training) {
    return costs_json(costs, training);
}

std::string strip_costs_json(const StripCosts& costs, std::string_view training) {
    return costs_json(costs, training);
}

std::string rank_net_json(const RankNetWeights& weights, std::string_view training) {
    (void)make_rank_net(weights);
    WeightsText file(1, training);
    const auto features = lane_feature_names().first(static_cast<std::size_t>(weights.mean.size()));
    Json hidden = Json::array();
    for (const auto& unit : weights.hidden.rowwise()) hidden.push_back(floats(unit));
    file.add("features", Json(std::vector<std::string>(features.begin(), features.end())).dump());
    file.add("mean", Json(std::vector<double>(weights.mean.begin(), weights.mean.end())).dump());
    file.add("deviation",
             Json(std::vector<double>(weights.deviation.begin(), weights.deviation.end())).dump());
    file.add("hidden", in_lines(hidden));
    file.add("hidden_bias", floats(weights.hidden_bias).dump());
    file.add("output", floats(weights.output).dump());
    file.add("output_bias", Json(shortest(weights.output_bias)).dump());
    return file.text();
}

std::string step_scores_json(const StepScores& scores, std::string_view training) {
    validate(scores);
    WeightsText file(1, training);
    Json measures = Json::object();
    auto next = scores.values.begin();
    for (const StepMeasure& measure : step_measures()) {
        const auto end = next + static_cast<std::ptrdiff_t>(measure.scores);
        measures[std::string(measure.name)] = {{"first", measure.first},
                                               {"spacing", measure.spacing},
                                               {"scores", std::vector<double>(next, end)}};
        next = end;
    }
    file.add("measures", in_lines(measures));
    return file.text();
}

}  // namespace conelane
