// RLD with simulated confidences and colors, measured on held-out tracks with the parameters of their folds.

#include "experiments/studies/confidence_and_colour.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/input_error.hpp"
#include "tests/support/file_test.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/testing.hpp"

namespace conelane::experiments {
namespace {

using testing::AnyOf;

ConfidenceColorOptions two_folds() {
    ConfidenceColorOptions options{.tracks = {"generated:straight", "generated:circle"}};
    options.scenes.false_positive_rates = {0.5};
    options.scenes.ranges_m = {30.0};
    options.scenes.every_m = 4.0;
    options.evaluation.nearest = 12;
    options.evaluation.time_limit_ms = 1e5;
    options.folds = {{{"straight"}, {}}, {{"circle"}, {}}};
    options.color_errors = {0.0, 1.0};
    options.color_weights = {0.0, 1.0};
    options.benefits = {1.0, 2.0};
    return options;
}

TEST(ConfidenceAndColor, ConfidencesAndRightColorsGainAndWrongOnesAreNotTrusted) {
    const std::vector<ConfidenceColorRow> rows = confidence_color_rows(two_folds());
    ASSERT_EQ(rows.size(), 4U);
    const ConfidenceColorRow& geometry = rows[0];
    EXPECT_EQ(geometry.knowledge, SimulatedKnowledge{});
    EXPECT_GT(geometry.scenes, 30U);
    EXPECT_GT(geometry.accurate, 0.3);
    EXPECT_TRUE(geometry.weights.empty());
    EXPECT_GT(rows[1].accurate, geometry.accurate + 0.05);  // confidences
    EXPECT_GT(rows[1].success, geometry.success);
    EXPECT_THAT(rows[1].weights, Each(AnyOf(1.0, 2.0)));
    EXPECT_GT(rows[2].accurate, geometry.accurate);  // right colors
    EXPECT_THAT(rows[2].weights, ElementsAre(1.0, 1.0));
    EXPECT_EQ(rows[3].knowledge.color_error, 1.0);  // every color is wrong, so each fold uses geometry only
    EXPECT_THAT(rows[3].weights, ElementsAre(0.0, 0.0));
    EXPECT_EQ(rows[3].accurate, geometry.accurate);
}

/// A fold whose parameters find no lane has no accurate lane on its held-out tracks; others are unaffected.
TEST(ConfidenceAndColor, AFoldAnswersForItsHeldOutTracksAlone) {
    ConfidenceColorOptions options = two_folds();
    options.color_errors.clear();
    const double both = confidence_color_rows(options).front().accurate;
    options.folds[1].parameters.d_h = 0.0;
    const ConfidenceColorRow one = confidence_color_rows(options).front();
    EXPECT_LT(one.accurate, both);
    EXPECT_GT(one.accurate, 0.1);
    options.folds[0].parameters.d_h = 0.0;
    EXPECT_EQ(confidence_color_rows(options).front().accurate, 0.0);
}

TEST(ConfidenceAndColor, CountOnlyTheTracksAskedFor) {
    ConfidenceColorOptions options = two_folds();
    options.color_errors.clear();
    options.folds[1].parameters.d_h = 0.0;  // finds no lane on the circle
    const std::size_t both = confidence_color_rows(options).front().scenes;
    options.only = {"circle"};
    const ConfidenceColorRow circle = confidence_color_rows(options).front();
    EXPECT_EQ(circle.accurate, 0.0);
    options.only = {"straight"};
    const ConfidenceColorRow straight = confidence_color_rows(options).front();
    EXPECT_GT(straight.accurate, 0.3);
    EXPECT_EQ(circle.scenes + straight.scenes, both);
    options.only = {"kidney"};
    EXPECT_THROW(static_cast<void>(confidence_color_rows(options)), InvalidInput);
}

TEST(ConfidenceAndColor, AreTheSameForAnyNumberOfThreads) {
    ConfidenceColorOptions options = two_folds();
    options.color_errors.clear();
    const std::vector<ConfidenceColorRow> one = confidence_color_rows(options);
    options.evaluation.threads = 2;
    options.scenes.threads = 2;
    EXPECT_TRUE(confidence_color_rows(options) == one);
}

TEST(ConfidenceAndColor, ATrackThatIsHeldOutMustBeThere) {
    ConfidenceColorOptions options = two_folds();
    options.folds[0].tracks = {"kidney"};
    EXPECT_THAT(refusal([&] { (void)confidence_color_rows(options); }), HasSubstr("kidney"));
}

class TuningRecord : public FileTest {};

TEST_F(TuningRecord, GivesScenesConeSetAndFolds) {
    const std::string parameters =
        R"({"d_e":3.3,"d_t":1.7,"theta_e":3.1,"theta_t":0.9,"w_s":0.3,"w_t":1,"w_p":3,"w_b":1,"d_min":2.8,)"
        R"("d_h":6.7,"theta_heading":1.2,"d_near":5.1,"d_max":6.1,"s_crit":3.7,"t_crit":4.2})";
    const auto text = [&](const std::string& folds) {
        return R"({"tracks":["generated:circle"],"fp":[0,0.5],"range":[30],"every":4.4,"noise":0.1,)"
               R"("pose_noise":[0.2,0.3],"miss":0.05,"seed":11,"time_limit_ms":100,"most_nodes":900,)"
               R"("pairing":"paper","forbid_crossing":true,"nearest":12,"context":24,"fold_results":[)" +
               folds + "]}";
    };
    std::ofstream(path("r")) << text(R"({"held_out":["circle"],"parameters":)" + parameters + "}");
    const ConfidenceColorOptions read = read_tuning_record(path("r"));
    EXPECT_THAT(read.tracks, ElementsAre("generated:circle"));
    EXPECT_THAT(read.scenes.false_positive_rates, ElementsAre(0.0, 0.5));
    EXPECT_THAT(read.scenes.ranges_m, ElementsAre(30.0));
    EXPECT_EQ(read.scenes.every_m, 4.4);
    EXPECT_EQ(read.scenes.noise_sigma_m, 0.1);
    EXPECT_EQ(read.scenes.pose_noise_lateral_m, 0.2);
    EXPECT_EQ(read.scenes.pose_noise_yaw_rad, 0.3);
    EXPECT_EQ(read.scenes.miss_rate, 0.05);
    EXPECT_EQ(read.scenes.seed, 11U);
    EXPECT_EQ(read.evaluation.nearest, 12U);
    EXPECT_EQ(read.evaluation.context, 24U);
    EXPECT_EQ(read.evaluation.max_nodes, 900);
    ASSERT_EQ(read.folds.size(), 1U);
    EXPECT_THAT(read.folds[0].tracks, ElementsAre("circle"));
    EXPECT_EQ(read.folds[0].parameters.d_e, 3.3);
    EXPECT_EQ(read.folds[0].parameters.pairing, Pairing::paper);
    EXPECT_TRUE(read.folds[0].parameters.forbid_crossing);

    std::ofstream(path("none")) << text("");
    EXPECT_THROW(static_cast<void>(read_tuning_record(path("none"))), InputError);
    std::ofstream(path("other")) << R"({"d_e":3})";
    EXPECT_THROW(static_cast<void>(read_tuning_record(path("other"))), InputError);
}

}  // namespace
}  // namespace conelane::experiments
