#include "graph_search/weights/shipped_weights.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/clc/lane_features.hpp"
#include "graph_search/front/front_judge_features.hpp"
#include "graph_search/weights/shipped_weight_tables.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace conelane {
namespace {

void require(bool valid, const std::string& key, const char* reason) {
    if (!valid) throw InvalidInput(key, reason);
}

/// Row by row; empty where the numbers do not fill whole rows, which make_rank_net refuses.
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

Eigen::VectorXd vector(std::span<const double> numbers) {
    return Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

RankNetWeights weights(const RankNetTable& table) {
    const std::span<const std::string_view> known = lane_feature_names();
    require(table.features.size() <= known.size() &&
                std::ranges::equal(table.features, known.first(table.features.size())),
            "features", "are not those of the library");
    require(table.features.size() == table.mean.size(), "mean", "must have one entry a feature");
    RankNetWeights result;
    result.mean = vector(table.mean);
    result.deviation = vector(table.deviation);
    result.hidden = matrix(table.hidden, table.mean.size());
    result.hidden_bias = vector(table.hidden_bias).cast<float>();
    result.output = vector(table.output).cast<float>();
    result.output_bias = static_cast<float>(table.output_bias);
    return result;
}

FrontNetworkWeights weights(const FrontNetworkTable& table) {
    const auto floats = [](std::span<const double> numbers) {
        std::vector<float> result;
        for (const double number : numbers) result.push_back(static_cast<float>(number));
        return result;
    };
    require(table.output_bias.size() == 1, "output_bias", "must be one number");
    return {table.linear.size(),  floats(table.hidden), floats(table.hidden_bias),
            floats(table.output), floats(table.linear), floats(table.output_bias).front()};
}

}  // namespace

RankNetWeights paper_rank_net_weights() {
    return weights(kPaperRankNet);
}

RankNetWeights extended_rank_net_weights() {
    return weights(kExtendedRankNet);
}

std::shared_ptr<const LaneRanking> paper_rank_net() {
    return make_rank_net(paper_rank_net_weights());
}

std::shared_ptr<const LaneRanking> extended_rank_net() {
    return make_rank_net(extended_rank_net_weights());
}

std::shared_ptr<const StepScores> shipped_step_scores() {
    auto scores = std::make_shared<StepScores>();
    for (const StepMeasure& measure : step_measures()) {
        const std::string key(measure.name);
        const auto table = std::ranges::find(kStepScores, measure.name, &StepScoreTable::measure);
        require(table != kStepScores.end(), key, "is missing");
        require(table->first == measure.first && table->spacing == measure.spacing &&
                    table->scores.size() == measure.scores,
                key, "does not stand where the library has it");
        scores->values.insert(scores->values.end(), table->scores.begin(), table->scores.end());
    }
    validate(*scores);
    return scores;
}

FrontWeights shipped_front_weights() {
    std::vector<std::string_view> known;
    for (const FrontFeatureList& list : front_feature_lists()) {
        for (const FrontFeature& feature : list.features) known.push_back(feature.name);
    }
    require(std::ranges::equal(kFront.features, known), "features", "are not those of the library");
    FrontWeights result{weights(kFront.extend), weights(kFront.stop),   weights(kFront.start),
                        weights(kFront.rank),   weights(kFront.usable), weights(kFront.right),
                        kFront.least_trust};
    validate(result);
    return result;
}

}  // namespace conelane
