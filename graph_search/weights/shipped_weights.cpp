#include "graph_search/weights/shipped_weights.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/clc/lane_features.hpp"
#include "graph_search/front/front_weights.hpp"
#include "graph_search/shared/weights_reader.hpp"
#include "graph_search/weights/weight_files.hpp"

namespace conelane {
namespace {

constexpr std::string_view kNetworkCommand = "conelane train";
constexpr std::string_view kStepsCommand = "conelane train --steps";

Eigen::VectorXd vector(const std::vector<double>& numbers) {
    return Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

Eigen::VectorXf vector(const std::vector<float>& numbers) {
    return Eigen::Map<const Eigen::VectorXf>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

}  // namespace

RankNetWeights parse_rank_net(std::string_view text) {
    WeightsReader file(text, "weights", kNetworkCommand);
    (void)file.version({1});
    const std::size_t inputs = file.first_names("features", lane_feature_names());
    const std::size_t units = file.size("hidden");
    RankNetWeights weights;
    weights.mean = vector(file.numbers("mean"));
    weights.deviation = vector(file.numbers("deviation"));
    if (weights.mean.size() != static_cast<Eigen::Index>(inputs))
        throw InvalidInput("mean", "must have one entry a feature");
    weights.hidden.resize(static_cast<Eigen::Index>(units), weights.mean.size());
    for (std::size_t i = 0; i < units; ++i) {
        weights.hidden.row(static_cast<Eigen::Index>(i)) =
            vector(file.floats("hidden[" + std::to_string(i) + "]", inputs)).transpose();
    }
    weights.hidden_bias = vector(file.floats("hidden_bias", units));
    weights.output = vector(file.floats("output", units));
    weights.output_bias = static_cast<float>(file.number("output_bias"));
    (void)make_rank_net(weights);
    return weights;
}

StepScores parse_step_scores(std::string_view text) {
    WeightsReader file(text, "scores", kStepsCommand);
    (void)file.version({1});
    StepScores scores;
    for (const StepMeasure& measure : step_measures()) {
        const std::string path = "measures." + std::string(measure.name);
        const auto require_equal = [&](const char* key, double expected) {
            if (file.number(path + key) != expected)
                throw InvalidInput(path + key, "is not that of the program");
        };
        require_equal(".first", measure.first);
        require_equal(".spacing", measure.spacing);
        const std::vector<double>& numbers = file.numbers(path + ".scores");
        if (numbers.size() != measure.scores)
            throw InvalidInput(path + ".scores",
                               "must be a list of " + std::to_string(measure.scores) + " numbers");
        scores.values.insert(scores.values.end(), numbers.begin(), numbers.end());
    }
    validate(scores);
    return scores;
}

std::string step_scores_training(std::string_view text) {
    return std::string(WeightsReader(text, "scores", kStepsCommand).training());
}

// Each file is read once, at the first request.

RankNetWeights paper_rank_net_weights() {
    return parse_rank_net(kRankNetPaperFile);
}

RankNetWeights extended_rank_net_weights() {
    return parse_rank_net(kRankNetExtendedFile);
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
    static const auto scores = std::make_shared<const StepScores>(parse_step_scores(kStepScoresFile));
    return scores;
}

FrontWeights shipped_front_weights() {
    static const FrontWeights weights = parse_front_weights(kFrontFile);
    return weights;
}

}  // namespace conelane
