#include "evaluation/formats/rank_net_file.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/weights/shipped_weights.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/test_paths.hpp"
#include "tests/support/testing.hpp"

#include <bit>
#include <type_traits>

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
    const auto key_of = [](const std::string& text) {
        return refused_key([&] { (void)parse_rank_net(text); });
    };
    const auto with = [&](const std::string& old_text, const std::string& new_text) {
        return with_other(json, old_text, new_text);
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

/// As bits, so that zeros of either sign differ.
template <typename Values>
auto bits(const Values& values) {
    using Scalar = typename Values::Scalar;
    using Bits = std::conditional_t<sizeof(Scalar) == 8, std::uint64_t, std::uint32_t>;
    std::vector<Bits> result;
    for (const Scalar value : values.reshaped()) result.push_back(std::bit_cast<Bits>(value));
    return result;
}

TEST(RankNetFile, TheNetworksInTheLibraryAreThoseOfTheirFilesToTheLastBit) {
    const auto expect_equal = [](const RankNetWeights& built_in, const RankNetWeights& read) {
        EXPECT_EQ(bits(built_in.mean), bits(read.mean));
        EXPECT_EQ(bits(built_in.deviation), bits(read.deviation));
        EXPECT_EQ(built_in.hidden.cols(), read.hidden.cols());
        EXPECT_EQ(bits(built_in.hidden), bits(read.hidden));
        EXPECT_EQ(bits(built_in.hidden_bias), bits(read.hidden_bias));
        EXPECT_EQ(bits(built_in.output), bits(read.output));
        EXPECT_EQ(std::bit_cast<std::uint32_t>(built_in.output_bias),
                  std::bit_cast<std::uint32_t>(read.output_bias));
    };
    expect_equal(paper_rank_net_weights(),
                 parse_rank_net(source_text("graph_search/weights/rank_net_paper.json")));
    expect_equal(extended_rank_net_weights(),
                 parse_rank_net(source_text("graph_search/weights/rank_net_extended.json")));
}

TEST(RankNetFile, TheShippedNetworksTellLanesApart) {
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
}

}  // namespace
}  // namespace conelane
