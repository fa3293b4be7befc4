#include "graph_search/rank_net_file.hpp"

#include "model/invalid_input.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace conelane {
namespace {

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

TEST(RankNetFile, GivesTheSameWeightsBack) {
    const RankNetWeights weights = small_network();
    const std::string json = rank_net_json(weights, R"({"seed": 3})");
    const RankNetWeights read = parse_rank_net(json);
    EXPECT_EQ(read.mean, weights.mean);
    EXPECT_EQ(read.deviation, weights.deviation);
    EXPECT_EQ(read.hidden, weights.hidden);
    EXPECT_EQ(read.hidden_bias, weights.hidden_bias);
    EXPECT_EQ(read.output, weights.output);
    EXPECT_EQ(read.output_bias, weights.output_bias);
    EXPECT_EQ(rank_net_json(read, R"({"seed": 3})"), json);
    EXPECT_NE(json.find("\"seed\": 3"), std::string::npos);
}

TEST(RankNetFile, ErrorsNameTheirKey) {
    const std::string json = rank_net_json(small_network(), "{}");
    const auto key_of = [](const std::string& text) -> std::string {
        try {
            (void)parse_rank_net(text);
        } catch (const InvalidInput& error) {
            return error.key();
        }
        return "accepted";
    };
    const auto with = [&](const std::string& old_text, const std::string& new_text) {
        std::string changed = json;
        const std::size_t at = changed.find(old_text);
        EXPECT_NE(at, std::string::npos) << old_text;
        return changed.replace(at, old_text.size(), new_text);
    };
    EXPECT_EQ(key_of(json), "accepted");
    EXPECT_EQ(key_of("no JSON"), "weights");
    EXPECT_EQ(key_of("[]"), "weights");
    EXPECT_EQ(key_of(with("\"version\": 1", "\"version\": 2")), "version");
    EXPECT_EQ(key_of(with("\"cones_left\"", "\"cones_right\"")), "features[1]");
    EXPECT_EQ(key_of(with("\"cones_left\"", "7")), "features[1]");
    EXPECT_EQ(key_of(with("\"mean\"", "\"meen\"")), "mean");
    EXPECT_EQ(key_of(with("\"mean\": [0.1,", "\"mean\": [")), "mean");
    EXPECT_EQ(key_of(with("\"mean\": [0.1", "\"mean\": [\"x\"")), "mean[0]");
    EXPECT_EQ(key_of(with("\"deviation\": [0.3", "\"deviation\": [-0.3")), "deviation");
    EXPECT_EQ(key_of(with("\"hidden\": [\n  [", "\"hidden\": [\n  [1,")), "hidden[0]");
    EXPECT_EQ(key_of(with("\"hidden\": [", "\"hidden\": [5,")), "hidden[0]");
    EXPECT_EQ(key_of(with("\"output_bias\": ", "\"output_bias\": null, \"x\": ")), "output_bias");
    EXPECT_THROW((void)rank_net_json(small_network(), "[]"), InvalidInput);
}

TEST(RankNetFile, TheShippedNetworksPreferTheLaneToItsDetour) {
    // Six cones a side, 3.5 m apart; in the other candidate one cone of the left side lies 1.6 m off.
    std::vector<Point> left;
    std::vector<Point> right;
    for (int i = 0; i < 6; ++i) {
        left.emplace_back(1.0 + 3.5 * i, 1.8);
        right.emplace_back(1.0 + 3.5 * i, -1.8);
    }
    std::vector<Point> detour = left;
    detour[3].y() += 1.6;
    std::vector<LaneFeatures> lanes(2);
    const PaperFeatures straight = paper_features(left, right);
    const PaperFeatures bent = paper_features(detour, right);
    std::copy(straight.begin(), straight.end(), lanes[0].begin());
    std::copy(bent.begin(), bent.end(), lanes[1].begin());
    std::vector<double> scores(2);
    paper_rank_net()->score(lanes, scores);
    EXPECT_GT(scores[0], scores[1]);
    extended_rank_net()->score(lanes, scores);
    EXPECT_NE(scores[0], scores[1]);
}

}  // namespace
}  // namespace conelane
