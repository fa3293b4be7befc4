// Files of weights: of front, of RLD's learned costs, of the ranking networks and of step scores.

#include "evaluation/formats/weights_file.hpp"

#include "detectors/parameters/learned_costs_reader.hpp"
#include "detectors/recipe.hpp"
#include "evaluation/formats/parameter_file.hpp"
#include "tests/support/file_test.hpp"
#include "tests/support/front_fixture.hpp"
#include "tests/support/learned_costs.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/text_tables.hpp"

#include <nlohmann/json.hpp>

namespace conelane {
namespace {

using tests::random_front_network;
using tests::random_front_weights;
using Json = nlohmann::ordered_json;

const std::string kTraining = R"({"seed": 3})";

FrontWeights colored_weights() {
    FrontWeights weights = random_front_weights(8);
    weights.colored = random_front_weights(9);
    weights.colored->least_trust = 0.625;
    return weights;
}

RankNetWeights small_network() {
    RankNetWeights weights;
    weights.mean = Eigen::VectorXd::LinSpaced(8, 0.1, 10.3);
    weights.deviation = Eigen::VectorXd::LinSpaced(8, 1.0 / 3.0, 5.0);
    weights.hidden = Eigen::MatrixXf::Random(3, 8);
    weights.hidden_bias = Eigen::VectorXf::Constant(3, 0.1F);
    weights.output = Eigen::VectorXf::Constant(3, -1.0F / 3.0F);
    weights.output_bias = 2e-8F;
    return weights;
}

StepScores uneven_scores() {
    StepScores scores;
    for (std::size_t i = 0; i < step_score_count(); ++i)
        scores.values.push_back(1.0 / (3.0 + static_cast<double>(i)) - 0.05);
    return scores;
}

/// A kind of file: one of it, and how it is read and written again.
struct Kind {
    std::string text;
    std::function<std::string(const std::string& text, const std::string& training)> again;
};

const std::map<std::string, Kind>& kinds() {
    static const auto front = [](const std::string& text, const std::string& training) {
        return front_weights_json(parse_front_weights(text), training);
    };
    static const std::map<std::string, Kind> kinds{
        {"front", {front_weights_json(random_front_weights(8), kTraining), front}},
        {"colored", {front_weights_json(colored_weights(), kTraining), front}},
        {"costs",
         {learned_costs_json(LearnedCosts::zero(1), kTraining),
          [](const std::string& text, const std::string& training) {
              return learned_costs_json(*parse_learned_costs(text), training);
          }}},
        {"strip",
         {strip_costs_json(StripCosts::zero(1), kTraining),
          [](const std::string& text, const std::string& training) {
              return strip_costs_json(*parse_strip_costs(text), training);
          }}},
        {"net",
         {rank_net_json(small_network(), kTraining),
          [](const std::string& text, const std::string& training) {
              return rank_net_json(parse_rank_net(text), training);
          }}},
        {"steps",
         {step_scores_json(uneven_scores(), kTraining),
          [](const std::string& text, const std::string& training) {
              return step_scores_json(parse_step_scores(text), training);
          }}}};
    return kinds;
}

TEST(WeightsFile, GivesTheSameWeightsBack) {
    for (const FrontWeights& weights : {random_front_weights(8), colored_weights()})
        EXPECT_TRUE(parse_front_weights(front_weights_json(weights, "{}")) == weights);
    for (const std::size_t units : {0U, 4U}) {
        const auto costs = tests::random_learned_costs(7, units);
        EXPECT_TRUE(*parse_learned_costs(learned_costs_json(*costs, "{}")) == *costs);
    }
    const RankNetWeights weights = small_network();
    const RankNetWeights read = parse_rank_net(rank_net_json(weights, "{}"));
    EXPECT_EQ(read.mean, weights.mean);
    EXPECT_EQ(read.deviation, weights.deviation);
    EXPECT_EQ(read.hidden, weights.hidden);
    EXPECT_EQ(read.hidden_bias, weights.hidden_bias);
    EXPECT_EQ(read.output, weights.output);
    EXPECT_EQ(read.output_bias, weights.output_bias);
    EXPECT_EQ(parse_step_scores(step_scores_json(uneven_scores(), "{}")).values, uneven_scores().values);
    for (const auto& [name, kind] : kinds()) {
        EXPECT_EQ(kind.again(kind.text, kTraining), kind.text) << name;
        for (const char* training : {"no JSON", "[]"})
            EXPECT_THROW((void)kind.again(kind.text, training), InvalidInput) << name;
    }
}

/// Weights that a writer must not write.
TEST(WeightsFile, HoldsValidWeightsAlone) {
    FrontWeights weights = colored_weights();
    weights.colored->stop.linear.pop_back();
    EXPECT_EQ(refused_key([&] { (void)front_weights_json(weights, "{}"); }), "colored_stop.linear");
    EXPECT_THROW((void)learned_costs_json(LearnedCosts{}, "{}"), InvalidInput);
    EXPECT_THROW((void)rank_net_json({}, "{}"), InvalidInput);
    EXPECT_THROW((void)step_scores_json({}, "{}"), InvalidInput);
}

/// The files of the library are those of its sources, and written again they are the same bytes.
TEST(WeightsFile, TheShippedOnesKeepEveryByte) {
    const std::vector<std::tuple<std::string, std::string, std::string_view>> shipped{
        {"front", "graph_search/weights/front.json", kFrontFile},
        {"net", "graph_search/weights/rank_net_paper.json", kRankNetPaperFile},
        {"net", "graph_search/weights/rank_net_extended.json", kRankNetExtendedFile},
        {"steps", "graph_search/weights/step_scores.json", kStepScoresFile},
        {"costs", "detectors/parameters/learned.weights.json", kLearnedWeightsFile},
        {"strip", "detectors/parameters/strip.weights.json", kStripWeightsFile}};
    for (const auto& [kind, path, embedded] : shipped) {
        const std::string text = source_text(path);
        EXPECT_TRUE(embedded == text) << path;
        const std::string training = Json::parse(text).at("training").dump();
        EXPECT_TRUE(kinds().at(kind).again(text, training) == text) << path;
    }
    EXPECT_EQ(Json::parse(step_scores_training(kStepScoresFile)),
              Json::parse(kStepScoresFile).at("training"));
}

/// refused_weights.txt has the faults.
TEST(WeightsFile, ErrorsNameTheirKey) {
    for (const tests::TableSection& section :
         tests::table_sections("evaluation/formats/refused_weights.txt")) {
        const Kind& kind = kinds().at(section.name);
        for (const std::string& line : section.lines) {
            const std::vector<std::string> parts = tests::split(tests::replaced(line, "\\n", "\n"), " => ");
            ASSERT_EQ(parts.size(), 2U) << line;
            const std::size_t arrow = parts[0].find(" -> ");
            const std::string text =
                with_other(kind.text, parts[0].substr(0, arrow), parts[0].substr(arrow + 4));
            EXPECT_THAT(refusal([&] { (void)kind.again(text, "{}"); }), testing::StartsWith(parts[1]))
                << line;
        }
    }
    const std::string deep = R"({"training": )" + std::string(1'000'000, '[') + "}";
    for (const auto& [name, kind] : kinds()) {
        const std::string what = name == "steps" ? "scores" : "weights";
        for (const std::string& text : {std::string(), std::string("no JSON"), std::string("[]")})
            EXPECT_THAT(refusal([&] { (void)kind.again(text, "{}"); }),
                        testing::StartsWith(what + ": line 1: must be a JSON object, as `conelane train"));
        EXPECT_THAT(refusal([&] { (void)kind.again(deep, "{}"); }), testing::HasSubstr("nested too deep"));
    }
}

/// A file of version 1 of front has no features of colors; its numbers are those of the other features.
TEST(WeightsFile, OfVersionOneKnowsNoColors) {
    FrontWeights weights = random_front_weights(8);
    weights.rank = random_front_network(kWholeLaneFeatures, 5);
    weights.right = random_front_network(kRightInputs, 6);
    // The inputs of a network that are features of colors, the last one first.
    const auto color_inputs = [](const FrontNetworkPlace& place) {
        std::vector<std::size_t> inputs;
        std::size_t end = 0;
        for (const FrontFeatureList& list : input_lists(place)) {
            end += list.features.size();
            for (std::size_t i = end - list.colors; i < end; ++i) inputs.insert(inputs.begin(), i);
        }
        return inputs;
    };
    for (const FrontNetworkPlace& place : kFrontNetworks) {
        FrontNetworkWeights& network = weights.*place.network;
        for (const std::size_t input : color_inputs(place)) {
            network.linear[input] = 0.0F;
            std::fill_n(network.hidden.begin() + static_cast<std::ptrdiff_t>(input * kFrontUnits),
                        kFrontUnits, 0.0F);
        }
    }
    Json json = Json::parse(front_weights_json(weights, "{}"));
    json["version"] = 1;
    for (const FrontFeatureList& list : front_feature_lists()) {
        auto& names = json["features"][std::string(list.key)];
        names.erase(names.end() - static_cast<std::ptrdiff_t>(list.colors), names.end());
    }
    for (const FrontNetworkPlace& place : kFrontNetworks) {
        auto& linear = json[std::string(place.key) + "_linear"];
        auto& hidden = json[std::string(place.key) + "_hidden"];
        for (const std::size_t input : color_inputs(place)) {
            linear.erase(input);
            const auto from = hidden.begin() + static_cast<std::ptrdiff_t>(input * kFrontUnits);
            hidden.erase(from, from + kFrontUnits);
        }
    }
    EXPECT_TRUE(parse_front_weights(json.dump()) == weights);
    json["version"] = 2;
    EXPECT_THROW((void)parse_front_weights(json.dump()), InvalidInput);
}

TEST(WeightsFile, TheShippedNetworksTellLanesApart) {
    // Two lanes that differ in the variance of the left turns.
    LaneFeatures smooth{};
    smooth.fill(1.0);
    LaneFeatures bent = smooth;
    bent[kTurnVarianceLeft] = 2.0;
    const std::vector<LaneFeatures> lanes{smooth, bent, smooth};
    for (const auto& ranking : {paper_rank_net(), extended_rank_net()}) {
        std::vector<double> scores(lanes.size());
        ranking->score(lanes, scores);
        EXPECT_TRUE(std::isfinite(scores[0]));
        EXPECT_NE(scores[0], scores[1]);
        EXPECT_EQ(scores[0], scores[2]);
    }
    const auto steps = shipped_step_scores();
    const std::size_t last = 10;
    for (const std::size_t measure : {kTurnMeasure, kSkewMeasure}) {
        const std::size_t straight_on = step_score_count(measure);
        EXPECT_GT(steps->values[straight_on], steps->values[straight_on + last]);
    }
}

class LearnedCostsFileTest : public FileTest {};

TEST_F(LearnedCostsFileTest, IsNamedByParameters) {
    RldParameters parameters{.d_gap = 9.0, .learned_costs = tests::random_learned_costs(2, 3)};
    write_rld_parameters(path("own.json"), parameters, R"({"seed": 5})");
    EXPECT_THAT(text_of(path("own.json")), testing::HasSubstr(R"("learned_costs": "own.weights.json")"));
    EXPECT_THAT(text_of(path("own.weights.json")), testing::HasSubstr(R"("seed": 5)"));
    const RldParameters read = read_rld_parameters(path("own.json"));
    ASSERT_TRUE(read.learned_costs);
    EXPECT_TRUE(*read.learned_costs == *parameters.learned_costs);
    EXPECT_EQ(tag_of("own.json", read), tag_of("own.json", parameters));
    RldParameters others = parameters;
    others.learned_costs = tests::random_learned_costs(3, 3);
    EXPECT_NE(tag_of("own.json", others).hash, tag_of("own.json", parameters).hash);
    others.learned_costs.reset();
    EXPECT_NE(tag_of("own.json", others).hash, tag_of("own.json", parameters).hash);

    const auto error_with = [&](const std::string& weights) {
        if (weights.empty()) {
            std::filesystem::remove(path("own.weights.json"));
        } else {
            std::ofstream(path("own.weights.json")) << weights;
        }
        return error_of([&] { static_cast<void>(read_rld_parameters(path("own.json"))); });
    };
    EXPECT_THAT(error_with("{}"), testing::AllOf(testing::StartsWith("own.json: learned_costs: weights: "),
                                                 testing::HasSubstr("own.weights.json: "),
                                                 testing::EndsWith("version: is missing")));
    EXPECT_THAT(error_with(""), testing::EndsWith("own.weights.json: cannot be read"));
}

}  // namespace
}  // namespace conelane
