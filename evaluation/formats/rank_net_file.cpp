#include "evaluation/formats/rank_net_file.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/clc/lane_features.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdlib>

#include <nlohmann/json.hpp>

namespace conelane {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;

const Json& member(const Json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end()) throw InvalidInput(key, "is missing");
    return *found;
}

std::string element_key(const std::string& key, std::size_t index) {
    return key + "[" + std::to_string(index) + "]";
}

double number(const Json& value, const std::string& key) {
    if (!value.is_number()) throw InvalidInput(key, "must be a number");
    return value.get<double>();
}

const Json& array(const Json& value, const std::string& key) {
    if (!value.is_array()) throw InvalidInput(key, "must be an array");
    return value;
}

template <typename Scalar>
Eigen::Matrix<Scalar, Eigen::Dynamic, 1> vector(const Json& values, const std::string& key) {
    array(values, key);
    Eigen::Matrix<Scalar, Eigen::Dynamic, 1> result(static_cast<Eigen::Index>(values.size()));
    for (std::size_t i = 0; i < values.size(); ++i) {
        result(static_cast<Eigen::Index>(i)) = static_cast<Scalar>(number(values[i], element_key(key, i)));
    }
    return result;
}

void require_known_features(const Json& names) {
    array(names, "features");
    const std::span<const std::string_view> known = lane_feature_names();
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (!names[i].is_string()) throw InvalidInput(element_key("features", i), "must be a string");
        if (i >= known.size() || names[i].get<std::string>() != known[i]) {
            throw InvalidInput(element_key("features", i),
                               "'" + names[i].get<std::string>() + "' is not the feature of that place");
        }
    }
}

/// The double nearest to the shortest decimal that reads back as the float `value`: this keeps files short.
double shortest(float value) {
    std::array<char, 32> text{};
    const auto [end, error] = std::to_chars(text.data(), text.data() + text.size() - 1, value);
    *end = '\0';
    return std::strtod(text.data(), nullptr);
}

template <typename Values>
Json numbers(const Values& values) {
    Json result = Json::array();
    for (Eigen::Index i = 0; i < values.size(); ++i) result.push_back(shortest(values(i)));
    return result;
}

Json parse_file(std::string_view json) {
    Json file = Json::parse(json, nullptr, false);
    if (!file.is_object()) throw InvalidInput("weights", "must be a JSON object");
    const Json& version = member(file, "version");
    if (!version.is_number_integer() || version.get<std::int64_t>() != kVersion) {
        throw InvalidInput("version", "must be " + std::to_string(kVersion));
    }
    return file;
}

}  // namespace

RankNetWeights parse_rank_net(std::string_view json) {
    const Json file = parse_file(json);
    const Json& features = member(file, "features");
    require_known_features(features);
    RankNetWeights weights;
    weights.mean = vector<double>(member(file, "mean"), "mean");
    weights.deviation = vector<double>(member(file, "deviation"), "deviation");
    if (weights.mean.size() != static_cast<Eigen::Index>(features.size())) {
        throw InvalidInput("mean", "must have one entry a feature");
    }
    const Json& units = array(member(file, "hidden"), "hidden");
    weights.hidden.resize(static_cast<Eigen::Index>(units.size()), weights.mean.size());
    for (std::size_t i = 0; i < units.size(); ++i) {
        const Eigen::VectorXf unit = vector<float>(units[i], element_key("hidden", i));
        if (unit.size() != weights.mean.size()) {
            throw InvalidInput(element_key("hidden", i), "must have one entry a feature");
        }
        weights.hidden.row(static_cast<Eigen::Index>(i)) = unit.transpose();
    }
    weights.hidden_bias = vector<float>(member(file, "hidden_bias"), "hidden_bias");
    weights.output = vector<float>(member(file, "output"), "output");
    weights.output_bias = static_cast<float>(number(member(file, "output_bias"), "output_bias"));
    (void)make_rank_net(weights);
    return weights;
}

std::string rank_net_json(const RankNetWeights& weights, std::string_view training) {
    (void)make_rank_net(weights);
    Json record = Json::parse(training, nullptr, false);
    if (!record.is_object()) throw InvalidInput("training", "must be a JSON object");
    Json file;
    file["version"] = kVersion;
    file["training"] = std::move(record);
    file["features"] = Json::array();
    for (Eigen::Index i = 0; i < weights.mean.size(); ++i) {
        file["features"].push_back(lane_feature_names()[static_cast<std::size_t>(i)]);
    }
    file["mean"] = Json(std::vector<double>(weights.mean.begin(), weights.mean.end()));
    file["deviation"] = Json(std::vector<double>(weights.deviation.begin(), weights.deviation.end()));
    file["hidden"] = Json::array();
    for (Eigen::Index unit = 0; unit < weights.hidden.rows(); ++unit) {
        file["hidden"].push_back(numbers(weights.hidden.row(unit)));
    }
    file["hidden_bias"] = numbers(weights.hidden_bias);
    file["output"] = numbers(weights.output);
    file["output_bias"] = shortest(weights.output_bias);
    // One line for each key, also of nested objects.
    std::string text = "{";
    const char* comma = "\n";
    for (const auto& [key, value] : file.items()) {
        text += comma + Json(key).dump() + ": ";
        comma = ",\n";
        const bool nested = key == "training" || key == "hidden";
        if (!nested) {
            text += value.dump();
            continue;
        }
        text += value.is_object() ? "{" : "[";
        const char* inner_comma = "\n  ";
        for (const auto& [inner_key, inner_value] : value.items()) {
            text += inner_comma;
            if (value.is_object()) text += Json(inner_key).dump() + ": ";
            text += inner_value.dump();
            inner_comma = ",\n  ";
        }
        text += value.is_object() ? "}" : "]";
    }
    return text + "\n}\n";
}

}  // namespace conelane
