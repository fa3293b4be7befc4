#include "graph_search/weights/shipped_weights.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/clc/lane_features.hpp"
#include "graph_search/front/front_weights_reader.hpp"
#include "graph_search/shared/json_reader.hpp"
#include "graph_search/weights/weight_files.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace conelane {
namespace {

constexpr double kVersion = 1.0;

void require(bool valid, const std::string& key, const char* reason) {
    if (!valid) throw InvalidInput(key, reason);
}

void append_numbers(JsonReader& json, std::vector<double>& numbers) {
    json.array([&] { numbers.push_back(json.number()); });
}

std::vector<double> numbers_of(JsonReader& json) {
    std::vector<double> numbers;
    append_numbers(json, numbers);
    return numbers;
}

Eigen::VectorXd vector(std::span<const double> numbers) {
    return Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

/// Row by row; empty if the numbers do not fill whole rows, which make_rank_net then refuses.
Eigen::MatrixXf matrix(std::span<const double> numbers, std::size_t columns) {
    if (columns == 0 || numbers.size() % columns != 0) return {};
    Eigen::MatrixXf result(static_cast<Eigen::Index>(numbers.size() / columns),
                           static_cast<Eigen::Index>(columns));
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        result(static_cast<Eigen::Index>(i / columns), static_cast<Eigen::Index>(i % columns)) =
            static_cast<float>(numbers[i]);
    }
    return result;
}

/// make_rank_net reports all other errors.
RankNetWeights rank_net_weights(std::string_view file) {
    RankNetWeights result;
    double version = 0.0;
    std::vector<std::string> features;
    std::vector<double> hidden;
    JsonReader json(file, "weights");
    json.object([&](const std::string& key) {
        if (key == "version") {
            version = json.number();
        } else if (key == "features") {
            json.array([&] { features.push_back(json.string()); });
        } else if (key == "mean") {
            result.mean = vector(numbers_of(json));
        } else if (key == "deviation") {
            result.deviation = vector(numbers_of(json));
        } else if (key == "hidden") {
            json.array([&] { append_numbers(json, hidden); });
        } else if (key == "hidden_bias") {
            result.hidden_bias = vector(numbers_of(json)).cast<float>();
        } else if (key == "output") {
            result.output = vector(numbers_of(json)).cast<float>();
        } else if (key == "output_bias") {
            result.output_bias = static_cast<float>(json.number());
        } else {
            json.skip();
        }
    });
    json.require_end();
    require(version == kVersion, "version", "must be 1");
    const std::span<const std::string_view> known = lane_feature_names();
    require(features.size() <= known.size() && std::ranges::equal(features, known.first(features.size())),
            "features", "are not those of the library");
    require(features.size() == static_cast<std::size_t>(result.mean.size()), "mean",
            "must have one entry a feature");
    result.hidden = matrix(hidden, features.size());
    return result;
}

struct StepScoreTable {
    double first = std::numeric_limits<double>::quiet_NaN();
    double spacing = std::numeric_limits<double>::quiet_NaN();
    std::vector<double> scores;
};

StepScoreTable step_score_table(JsonReader& json) {
    StepScoreTable table;
    json.object([&](const std::string& key) {
        if (key == "first") {
            table.first = json.number();
        } else if (key == "spacing") {
            table.spacing = json.number();
        } else if (key == "scores") {
            table.scores = numbers_of(json);
        } else {
            json.skip();
        }
    });
    return table;
}

StepScores step_scores(std::string_view file) {
    double version = 0.0;
    std::map<std::string, StepScoreTable, std::less<>> tables;
    JsonReader json(file, "scores");
    json.object([&](const std::string& key) {
        if (key == "version") {
            version = json.number();
        } else if (key == "measures") {
            json.object([&](const std::string& measure) { tables[measure] = step_score_table(json); });
        } else {
            json.skip();
        }
    });
    json.require_end();
    require(version == kVersion, "version", "must be 1");
    StepScores scores;
    for (const StepMeasure& measure : step_measures()) {
        const std::string key(measure.name);
        const auto table = tables.find(key);
        require(table != tables.end(), key, "is missing");
        const StepScoreTable& found = table->second;
        require(found.first == measure.first && found.spacing == measure.spacing &&
                    found.scores.size() == measure.scores,
                key, "is not at the place that the library expects");
        scores.values.insert(scores.values.end(), found.scores.begin(), found.scores.end());
    }
    validate(scores);
    return scores;
}

}  // namespace

// Each file is read once, at the first request.

RankNetWeights paper_rank_net_weights() {
    return rank_net_weights(kRankNetPaperFile);
}

RankNetWeights extended_rank_net_weights() {
    return rank_net_weights(kRankNetExtendedFile);
}

std::shared_ptr<const LaneRanking> paper_rank_net() {
    static const std::shared_ptr<const LaneRanking> net = make_rank_net(paper_rank_net_weights());
    return net;
}

std::shared_ptr<const LaneRanking> extended_rank_net() {
    static const std::shared_ptr<const LaneRanking> net = make_rank_net(extended_rank_net_weights());
    return net;
}

std::shared_ptr<const StepScores> shipped_step_scores() {
    static const auto scores = std::make_shared<const StepScores>(step_scores(kStepScoresFile));
    return scores;
}

FrontWeights shipped_front_weights() {
    static const FrontWeights weights = parse_front_weights(kFrontFile);
    return weights;
}

}  // namespace conelane
