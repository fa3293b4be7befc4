#include "evaluation/scoring/score_table.hpp"

#include "evaluation/formats/json_node.hpp"
#include "evaluation/scoring/published_figures.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

KeyedScore keyed(const std::string& detector, std::optional<double> rate, std::optional<double> range_m,
                 Category category, double iou) {
    SceneScore score{.category = category, .iou = iou, .divergence_known = true, .latency_ms = 12.5};
    return {{detector, rate, range_m}, score};
}

std::vector<std::vector<std::string>> words_of_lines(const std::string& text) {
    std::vector<std::vector<std::string>> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
        std::istringstream words(line);
        lines.emplace_back();
        for (std::string word; words >> word;) lines.back().push_back(word);
    }
    return lines;
}

TEST(SummariseByKey, GroupsDetectorsInOrderOfAppearanceThenRateThenRange) {
    const std::vector<ScoreRow> rows = summarise_by_key(std::vector<KeyedScore>{
        keyed("rld", 0.3, 50, Category::none, 0),
        keyed("clc", 0.1, 30, Category::ground_truth, 1),
        keyed("rld", 0.3, 30, Category::none, 0),
        keyed("rld", 0.1, 50, Category::none, 0),
        keyed("rld", {}, {}, Category::none, 0),
        keyed("rld", 0.3, 50, Category::ground_truth, 1),
    });
    EXPECT_THAT(
        mapped(rows, &ScoreRow::key),
        testing::ElementsAre(ScoreKey{"rld", {}, {}}, ScoreKey{"rld", 0.1, 50}, ScoreKey{"rld", 0.3, 30},
                             ScoreKey{"rld", 0.3, 50}, ScoreKey{"clc", 0.1, 30}));
    EXPECT_EQ(rows[3].summary.scenes, 2u);
    EXPECT_DOUBLE_EQ(rows[3].summary.mean_iou.value(), 0.5);
}

TEST(SummaryJson, HoldsWhatDetectorsSayOfTheirLanesWhereTheyDo) {
    std::vector<KeyedScore> scores{keyed("silent", 0.3, 30, Category::ground_truth, 1),
                                   keyed("front", 0.3, 30, Category::ground_truth, 1),
                                   keyed("front", 0.3, 30, Category::diverging_below_20, 0.5)};
    scores[0].score.trusted_m = 10.0;  // by a rule, without a probability
    scores[1].score.confidence = 0.96;
    scores[1].score.lane_length_m = 20.0;
    scores[1].score.trusted_m = 20.0;
    scores[2].score.confidence = 0.92;
    scores[2].score.lane_length_m = 20.0;
    scores[2].score.trusted_m = 10.0;
    scores[2].score.divergence_distance_m = 9.0;
    const std::vector<ScoreRow> rows = summarise_by_key(scores);
    EXPECT_THAT(summary_json(rows[0]).dump(), Not(HasSubstr("calibration")));
    const auto said = summary_json(rows[1]).at("calibration");
    EXPECT_NEAR(said.at("error").get<double>(), 0.94 - 0.5, 1e-12);
    EXPECT_EQ(said.at("sure_share"), 0.0);
    EXPECT_FALSE(said.contains("usable_where_sure_share"));
    EXPECT_EQ(said.at("right_where_trusted_share"), 0.5);
    EXPECT_EQ(said.at("trusted_share"), 0.75);
    EXPECT_EQ(said.at("bins").size(), 1u);
    EXPECT_EQ(said.at("bins")[0][0], 2);
}

TEST(ScoreTable, HasARowForEachKeyAndThePublishedOnesOfTheSameRates) {
    const std::vector<ScoreRow> rows = summarise_by_key(std::vector<KeyedScore>{
        keyed("clc", 0.3, 30, Category::near_ground_truth, 0.9),
        keyed("clc", 0.3, 30, Category::diverging_below_20, 0.2),
    });
    const std::string table = score_table(rows);
    const auto lines = words_of_lines(table);
    ASSERT_EQ(lines.size(), 7u) << table;
    EXPECT_THAT(lines[1], testing::ElementsAre("clc", "30.0", "30", "2", "50.0", "50.0", "55.0", "-", "0.0",
                                               "50.0", "0.0", "0.0", "50.0", "0.0", "0.0", "-", "-", "-", "-",
                                               "-", "-", "12.50", "12.50", "12.50", "12.50", "12.50"));
    EXPECT_THAT(lines[3], testing::ElementsAre("CLC", "paper", "30.0", "30+50", "-", "-", "99.3", "93.2", "-",
                                               "9.3", "85.1", "0.8", "4.1", "0.7", "-", "-", "-", "-", "-",
                                               "-", "13.4", "-", "<5", "-", "-", "-", "12"));
    EXPECT_THAT(table, HasSubstr("96.38"));
    EXPECT_THAT(table, HasSubstr(">90"));
    EXPECT_THAT(lines[6], testing::IsSupersetOf({"n=12", "97.19", "71.79", "155.88"}));
    // Columns are aligned: every line but the title of the published part is as long as the first.
    std::istringstream stream(table);
    std::string first;
    std::getline(stream, first);
    int as_long = 0;
    for (std::string line; std::getline(stream, line);) as_long += line.size() == first.size() ? 1 : 0;
    EXPECT_EQ(as_long, 5);
}

TEST(ScoreTable, NamesTheConditionsWhereThereAreAny) {
    KeyedScore paper = keyed("clc", 0.3, 30, Category::ground_truth, 1.0);
    EXPECT_THAT(score_table(summarise_by_key(std::vector{paper})), Not(HasSubstr("condition")));
    paper.key.condition = "paper";
    KeyedScore car = keyed("clc", 0.1, 30, Category::none, 0.0);
    car.key.condition = "car";
    const auto rows = summarise_by_key(std::vector{paper, car});
    ASSERT_EQ(rows.size(), 2u) << "in the order in which they appear, whatever the rate";
    EXPECT_EQ(rows[0].key.condition, "paper");
    EXPECT_EQ(rows[1].key.condition, "car");
    const auto lines = words_of_lines(score_table(rows));
    EXPECT_EQ(lines[0][1], "condition");
    EXPECT_EQ(lines[2][1], "car");
    EXPECT_EQ(summary_json(rows[1]).at("condition"), "car");
}

TEST(ScoreTable, ShowsWhatIsUnknownAsUnknown) {
    KeyedScore unknown = keyed("clc", {}, {}, Category::near_ground_truth, 0.9);
    unknown.score.divergence_known = false;
    const std::string table = score_table(summarise_by_key(std::vector<KeyedScore>{unknown}));
    const auto lines = words_of_lines(table);
    EXPECT_THAT(lines[1], testing::ElementsAre("clc", "-", "-", "1", "-", "-", "90.0", "-", "0.0", "-", "-",
                                               "-", "-", "0.0", "0.0", "-", "-", "-", "-", "-", "-", "12.50",
                                               "12.50", "12.50", "12.50", "12.50"));
    EXPECT_THAT(table, HasSubstr("scenes scored without the boundaries of their track: 1\n"));
    EXPECT_THAT(table, HasSubstr("34.5")) << "without a rate of its own, all published ones";
}

TEST(ScoreTable, EachLatencyStandsBelowItsName) {
    std::vector<KeyedScore> scores;
    for (int i = 1; i <= 100; ++i) {  // one of 100 takes 150 ms instead of 100 ms
        scores.push_back(keyed("clc", 0.3, 30, Category::ground_truth, 1.0));
        scores.back().score.latency_ms = i == 100 ? 150.0 : i;
    }
    const auto words = words_of_lines(score_table(summarise_by_key(scores)))[1];
    ASSERT_EQ(words.size(), 26u);
    EXPECT_THAT(std::vector(words.end() - 5, words.end()),
                testing::ElementsAre("50.50", "51.00", "95.00", "99.00", "150.00"));
}

TEST(ScoreTable, TellsErrorsFromScenesWithoutALane) {
    KeyedScore failed = keyed("clc", 0.5, 30, Category::none, 0.0);
    failed.score.error = true;
    const auto rows =
        summarise_by_key(std::vector<KeyedScore>{failed, keyed("clc", 0.5, 30, Category::none, 0.0)});
    EXPECT_EQ(rows.front().summary.errors, 1u);
    EXPECT_EQ(summary_json(rows.front()).at("errors"), 1);
    const auto words = words_of_lines(score_table(rows))[1];
    EXPECT_EQ(words[13], "50.0") << "each scene stands in one column";
    EXPECT_EQ(words[14], "50.0");
}

TEST(SummaryJson, IsOneLineWithoutUnknownMeasures) {
    const auto rows = summarise_by_key(
        std::vector<KeyedScore>{keyed("new\nline \xff", 0.5, 30, Category::ground_truth, 1)});
    const std::string line = to_line(summary_json(rows.front()));
    EXPECT_THAT(line, Not(HasSubstr("\n")));
    const auto json = nlohmann::json::parse(line);
    EXPECT_EQ(json.at("false_positive_rate"), 0.5);
    EXPECT_EQ(json.at("range"), 30.0);
    EXPECT_EQ(json.at("share").at("ground_truth"), 1.0);
    EXPECT_EQ(json.at("share").size(), kCategoryCount);
    EXPECT_EQ(json.at("latency_ms").at("p99"), 12.5);
    EXPECT_FALSE(json.contains("accurate_share"));
    EXPECT_FALSE(json.contains("solved_share"));
}

TEST(PublishedFigures, CategoriesOfARateSumToAllAndToTheStatedSuccess) {
    for (const PublishedClcRow& row : kPublishedClc) {
        const double success =
            row.ground_truth + row.near_ground_truth + row.too_short + row.diverging_from_20;
        EXPECT_NEAR(success, row.success, 0.15) << row.false_positive_rate;
        EXPECT_NEAR(success + row.diverging_below_20, 100.0, 0.15) << row.false_positive_rate;
    }
}

}  // namespace
}  // namespace conelane
