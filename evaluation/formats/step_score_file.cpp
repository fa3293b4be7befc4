#include "evaluation/formats/step_score_file.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/weights/weight_files.hpp"

#include <cstdint>

#include <nlohmann/json.hpp>

namespace conelane {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;

const Json& member(const Json& object, const std::string& key, const std::string& path) {
    const auto found = object.find(key);
    if (found == object.end()) throw InvalidInput(path, "is missing");
    return *found;
}

Json parse_file(std::string_view json) {
    constexpr int kDeepest = 100;  // deepest nesting in `training`, because writing it again is recursive
    const auto limit_depth = [](int depth, Json::parse_event_t /*event*/, const Json& /*value*/) {
        if (depth > kDeepest) throw InvalidInput("scores", "are nested too deeply");
        return true;
    };
    Json file = Json::parse(json, limit_depth, false);
    if (!file.is_object()) throw InvalidInput("scores", "must be a JSON object");
    const Json& version = member(file, "version", "version");
    if (!version.is_number_integer() || version.get<std::int64_t>() != kVersion) {
        throw InvalidInput("version", "must be " + std::to_string(kVersion));
    }
    return file;
}

double number(const Json& value, const std::string& path) {
    if (!value.is_number()) throw InvalidInput(path, "must be a number");
    return value.get<double>();
}

void require_equal(double value, double expected, const std::string& path) {
    if (value != expected) throw InvalidInput(path, "is not that of the program");
}

}  // namespace

std::string step_scores_training(std::string_view json) {
    return member(parse_file(json), "training", "training").dump();
}

StepScores parse_step_scores(std::string_view json) {
    const Json file = parse_file(json);
    const Json& measures = member(file, "measures", "measures");
    if (!measures.is_object()) throw InvalidInput("measures", "must be an object");
    StepScores result;
    for (const StepMeasure& measure : step_measures()) {
        const std::string path = "measures." + std::string(measure.name);
        const Json& table = member(measures, std::string(measure.name), path);
        if (!table.is_object()) throw InvalidInput(path, "must be an object");
        require_equal(number(member(table, "first", path + ".first"), path + ".first"), measure.first,
                      path + ".first");
        require_equal(number(member(table, "spacing", path + ".spacing"), path + ".spacing"), measure.spacing,
                      path + ".spacing");
        const Json& scores = member(table, "scores", path + ".scores");
        if (!scores.is_array() || scores.size() != measure.scores) {
            throw InvalidInput(path + ".scores",
                               "must be an array of " + std::to_string(measure.scores) + " numbers");
        }
        for (std::size_t i = 0; i < scores.size(); ++i) {
            result.values.push_back(number(scores[i], path + ".scores[" + std::to_string(i) + "]"));
        }
    }
    validate(result);
    return result;
}

std::string step_scores_json(const StepScores& scores, std::string_view training) {
    validate(scores);
    const Json record = Json::parse(training, nullptr, false);
    if (!record.is_object()) throw InvalidInput("training", "must be a JSON object");
    std::string text = "{\n\"version\": " + std::to_string(kVersion) + ",\n\"training\": {";
    const char* comma = "\n  ";
    for (const auto& [key, value] : record.items()) {
        text += comma + Json(key).dump() + ": " + value.dump();
        comma = ",\n  ";
    }
    text += "},\n\"measures\": {";
    comma = "\n  ";
    std::size_t at = 0;
    for (const StepMeasure& measure : step_measures()) {
        Json table;
        table["first"] = measure.first;
        table["spacing"] = measure.spacing;
        table["scores"] = Json::array();
        for (std::size_t i = 0; i < measure.scores; ++i) table["scores"].push_back(scores.values[at++]);
        text += comma + Json(std::string(measure.name)).dump() + ": " + table.dump();
        comma = ",\n  ";
    }
    return text + "}\n}\n";
}

std::string_view shipped_step_score_file() {
    return kStepScoresFile;
}

}  // namespace conelane
