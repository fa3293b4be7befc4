// Files of the weights of `front`.

#include "evaluation/formats/front_weights_file.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/front/front_judge_features.hpp"
#include "graph_search/weights/shipped_weights.hpp"
#include "tests/support/front_fixture.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/test_paths.hpp"
#include "tests/support/testing.hpp"

#include <nlohmann/json.hpp>

namespace conelane {
namespace {

using tests::random_front_network;
using tests::random_front_weights;

TEST(FrontWeightsFile, GivesTheSameWeightsBack) {
    const FrontWeights weights = random_front_weights(8);
    EXPECT_TRUE(parse_front_weights(front_weights_json(weights, R"({"seed": 1})")) == weights);
}

TEST(FrontWeightsFile, HasASetForColors) {
    FrontWeights weights = random_front_weights(8);
    weights.colored = random_front_weights(9);
    weights.colored->least_trust = 0.625;
    const std::string text = front_weights_json(weights, "{}");
    EXPECT_TRUE(parse_front_weights(text) == weights);
    const auto key_of = [](const nlohmann::ordered_json& json) {
        return refused_key([&] { (void)parse_front_weights(json.dump()); });
    };
    for (const std::string key : {"colored_start_linear", "colored_least_trust"}) {
        auto json = nlohmann::ordered_json::parse(text);
        json.erase(key);
        EXPECT_EQ(key_of(json), key);
        json["version"] = 2;
        EXPECT_TRUE(key_of(json).starts_with("colored_")) << "of version 3";
    }
    weights.colored->stop.linear.pop_back();
    EXPECT_EQ(refused_key([&] { validate(weights); }), "colored_stop.linear");
}

TEST(FrontWeightsFile, TheLibraryHasTheWeightsOfItsFile) {
    EXPECT_TRUE(parse_front_weights(source_text("graph_search/weights/front.json")) ==
                shipped_front_weights());
}

/// A file of version 1 has no features of colors; its numbers are those of the other features.
TEST(FrontWeightsFile, OfVersionOneKnowNoColors) {
    FrontWeights weights = random_front_weights(8);
    weights.rank = random_front_network(kWholeLaneFeatures, 5);
    weights.right = random_front_network(kRightInputs, 6);
    // The blocks of inputs of each network, with the number of color features in each.
    using Blocks = std::vector<std::pair<std::size_t, std::size_t>>;
    const Blocks state_and_extend{{kStateFeatures, kStateColorFeatures},
                                  {kExtendFeatures, kExtendColorFeatures}};
    Blocks right{{kConeFeatures, 0}};
    right.insert(right.end(), state_and_extend.begin(), state_and_extend.end());
    const std::vector<std::pair<FrontNetworkWeights*, Blocks>> networks{
        {&weights.extend, state_and_extend},
        {&weights.stop, {{kStateFeatures, kStateColorFeatures}, {kStopFeatures, kStopColorFeatures}}},
        {&weights.start, {{kStartFeatures, kStartColorFeatures}}},
        {&weights.rank, {{kWholeLaneFeatures, kWholeLaneColorFeatures}}},
        {&weights.usable, {{kWholeLaneFeatures, kWholeLaneColorFeatures}}},
        {&weights.right, right}};
    const auto for_each_color = [](const Blocks& blocks, const auto& use) {
        std::size_t first = 0;
        for (const auto& [inputs, colors] : blocks) {
            for (std::size_t i = inputs - colors; i < inputs; ++i) use(first + i);
            first += inputs;
        }
    };
    for (const auto& [network, blocks] : networks) {
        for_each_color(blocks, [net = network](std::size_t input) {
            net->linear[input] = 0.0F;
            std::fill_n(net->hidden.begin() + static_cast<std::ptrdiff_t>(input * kFrontUnits), kFrontUnits,
                        0.0F);
        });
    }
    nlohmann::ordered_json json = nlohmann::ordered_json::parse(front_weights_json(weights, "{}"));
    json["version"] = 1;
    for (const FrontFeatureList& list : front_feature_lists()) {
        auto& names = json["features"][std::string(list.key)];
        names.erase(names.end() - static_cast<std::ptrdiff_t>(list.colors), names.end());
    }
    const std::array keys{"extend", "stop", "start", "rank", "usable", "right"};
    for (std::size_t n = 0; n < keys.size(); ++n) {
        std::vector<std::size_t> colors;
        for_each_color(networks[n].second, [&](std::size_t input) { colors.push_back(input); });
        auto& linear = json[keys[n] + std::string("_linear")];
        auto& hidden = json[keys[n] + std::string("_hidden")];
        for (const std::size_t input : std::views::reverse(colors)) {
            linear.erase(input);
            const auto from = hidden.begin() + static_cast<std::ptrdiff_t>(input * kFrontUnits);
            hidden.erase(from, from + kFrontUnits);
        }
    }
    EXPECT_TRUE(parse_front_weights(json.dump()) == weights);
    json["version"] = 2;
    EXPECT_THROW((void)parse_front_weights(json.dump()), InvalidInput);
}

TEST(FrontWeightsFile, ErrorsNameTheKey) {
    const std::string good = front_weights_json(random_front_weights(8), "{}");
    const auto key_of = [&](const std::string& from, const std::string& to) {
        return refused_key([&] { (void)parse_front_weights(with_other(good, from, to)); });
    };
    EXPECT_EQ(key_of("\"version\": 2", "\"version\": 4"), "version");
    EXPECT_EQ(key_of("\"version\": 2", "\"version\": 3"), "colored_extend_hidden");
    EXPECT_EQ(key_of("\"version\": 2", "\"version\": 1"), "features");  // which has no colors
    EXPECT_EQ(key_of("own_segment_known", "unknown"), "features");
    EXPECT_EQ(key_of("\"stop_linear\"", "\"stop_lines\""), "stop_linear");
    EXPECT_EQ(key_of("\"start_hidden\": [", "\"start_hidden\": [1,"), "start_hidden");
    EXPECT_EQ(key_of("\"extend_output\": [", "\"extend_output\": [\"a\","), "extend_output");
    EXPECT_EQ(key_of("\"version\"", "\"edition\""), "version");
    EXPECT_EQ(key_of("\"version\"", "\"edition\": 3,\n\"version\""), "edition");
    EXPECT_THROW((void)front_weights_json(random_front_weights(8), "no JSON"), InvalidInput);
}

}  // namespace
}  // namespace conelane
