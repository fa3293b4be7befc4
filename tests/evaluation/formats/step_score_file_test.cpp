#include "evaluation/formats/step_score_file.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/weights/shipped_weights.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/test_paths.hpp"
#include "tests/support/testing.hpp"

#include <bit>

namespace conelane {
namespace {

StepScores uneven_scores() {
    StepScores scores;
    for (std::size_t i = 0; i < step_score_count(); ++i) {
        scores.values.push_back(1.0 / (3.0 + static_cast<double>(i)) - 0.05);
    }
    return scores;
}

TEST(StepScoreFile, GivesTheSameScoresBack) {
    const StepScores scores = uneven_scores();
    const std::string json = step_scores_json(scores, R"({"seed": 3})");
    const StepScores read = parse_step_scores(json);
    EXPECT_EQ(read.values, scores.values);
    EXPECT_EQ(step_scores_json(read, R"({"seed": 3})"), json);
    EXPECT_EQ(step_scores_training(json), R"({"seed":3})");
}

TEST(StepScoreFile, ErrorsNameTheirKey) {
    const std::string json = step_scores_json(uneven_scores(), "{}");
    const auto key_of = [](const std::string& text) {
        return refused_key([&] { (void)parse_step_scores(text); });
    };
    const auto with = [&](const std::string& old_text, const std::string& new_text) {
        return with_other(json, old_text, new_text);
    };
    EXPECT_EQ(key_of(json), "accepted");
    EXPECT_EQ(key_of("no JSON"), "scores");
    const std::string deep = std::string(1'000'000, '[') + std::string(1'000'000, ']');
    EXPECT_EQ(key_of(R"({"training": )" + deep + "}"), "scores") << "no crash";
    EXPECT_EQ(key_of(with("\"version\": 1", "\"version\": 2")), "version");
    EXPECT_EQ(key_of(with("\"measures\"", "\"other\"")), "measures");
    EXPECT_EQ(key_of(with("\"width_m\"", "\"depth_m\"")), "measures.width_m");
    EXPECT_EQ(key_of(with("\"start_width_m\": {\"first\":2.5", "\"start_width_m\": {\"first\":2.0")),
              "measures.start_width_m.first");
    EXPECT_EQ(key_of(with("\"spacing\":0.5", "\"spacing\":\"x\"")), "measures.start_width_m.spacing");
    EXPECT_EQ(key_of(with("\"steps\": {\"first\":0.0,\"spacing\":1.0,\"scores\":[",
                          "\"steps\": {\"first\":0.0,\"spacing\":1.0,\"scores\":[1,")),
              "measures.steps.scores");
    EXPECT_EQ(key_of(with("\"steps\": {\"first\":0.0,\"spacing\":1.0,\"scores\":[",
                          "\"steps\": {\"first\":0.0,\"spacing\":1.0,\"scores\":[null], \"x\":[")),
              "measures.steps.scores[0]");
    EXPECT_THROW((void)step_scores_json({}, "{}"), InvalidInput);
    EXPECT_THROW((void)step_scores_json(uneven_scores(), "[]"), InvalidInput);
}

TEST(StepScoreFile, TheScoresInTheLibraryAreThoseOfTheirFileToTheLastBit) {
    const std::string file = source_text("graph_search/weights/step_scores.json");
    EXPECT_EQ(shipped_step_score_file(), file);
    const std::vector<double> read = parse_step_scores(file).values;
    const std::vector<double> built_in = shipped_step_scores()->values;
    ASSERT_EQ(built_in.size(), read.size());
    for (std::size_t i = 0; i < read.size(); ++i) {
        EXPECT_EQ(std::bit_cast<std::uint64_t>(built_in[i]), std::bit_cast<std::uint64_t>(read[i])) << i;
    }
}

TEST(StepScoreFile, TheShippedScoresPreferStraightOn) {
    const auto scores = shipped_step_scores();
    const std::size_t turn = step_score_count(kTurnMeasure);
    const std::size_t skew = step_score_count(kSkewMeasure);
    const std::size_t last = 10;
    EXPECT_GT(scores->values[turn], scores->values[turn + last]);
    EXPECT_GT(scores->values[skew], scores->values[skew + last]);
}

}  // namespace
}  // namespace conelane
