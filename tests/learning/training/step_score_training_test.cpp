#include "learning/training/clc_training.hpp"
#include "tests/support/refusal.hpp"

namespace conelane::learning {
namespace {

SceneSet scenes(const std::string& track, double every_m, double rate = 0.4) {
    SceneOptions options{.false_positive_rates = {rate}, .ranges_m = {30.0}, .every_m = every_m};
    return make_scene_set({track}, options);
}

StepScoreTrainingOptions quick() {
    return StepScoreTrainingOptions{.epochs = 2, .show_progress = false};
}

StepScores untrained() {
    return {std::vector<double>(step_score_count(), 0.0)};
}

TEST(StepScoreTraining, LearnsToKeepTheRightLane) {
    const StepScores scores = train_step_scores(scenes("generated:hairpins@1", 4.0), quick());
    const SceneSet other = scenes("generated:kidney@2", 10.0);
    const StepScoreFigures before = step_score_figures(other, untrained(), {});
    const StepScoreFigures after = step_score_figures(other, scores, {});
    EXPECT_GT(after.scenes, 20u);
    EXPECT_EQ(after.scenes, before.scenes);
    EXPECT_EQ(after.start_share, before.start_share);
    EXPECT_LT(before.kept_share, 0.3);
    EXPECT_GT(after.kept_share, 0.8);
    EXPECT_GE(after.near_kept_share, after.kept_share);
    EXPECT_GE(after.start_share, after.near_kept_share);
}

TEST(StepScoreTraining, GivesTheSameScoresAgainAndOthersFromAnotherSeed) {
    const SceneSet set = scenes("generated:slalom@1", 20.0);
    StepScoreTrainingOptions options = quick();
    const StepScores scores = train_step_scores(set, options);
    EXPECT_EQ(train_step_scores(set, options).values, scores.values);
    options.seed = 1;
    EXPECT_NE(train_step_scores(set, options).values, scores.values);
    options.search.beam_width = 0;
    EXPECT_EQ(refused_key([&] { (void)train_step_scores(set, options); }), "beam_width");
    EXPECT_THROW((void)train_step_scores({}, quick()), InvalidInput);
}

TEST(StepScoreTraining, ABeamAsWideAsTheSceneKeepsEveryLane) {
    CandidateSearchOptions search{.beam_width = 100'000};
    const StepScoreFigures figures =
        step_score_figures(scenes("generated:circle@1", 30.0, 0.0), untrained(), search);
    EXPECT_GT(figures.scenes, 0u);
    EXPECT_GT(figures.start_share, 0.9);
    EXPECT_GT(figures.near_kept_share, 0.5) << "of lanes with the same last vertices one goes on";
}

TEST(StepScoreTraining, ARunRecordsWhatItDependedOn) {
    StepTrainingRunOptions options;
    options.tracks = {"generated:slalom@1"};
    options.hold_out = {"generated:kidney@2"};
    options.scenes.false_positive_rates = {0.3};
    options.scenes.ranges_m = {30.0};
    options.scenes.every_m = 20.0;
    options.hold_out_every_m = 40.0;
    options.training = quick();
    const TrainingRun run = run_step_training(options);
    EXPECT_THAT(run.file,
                testing::HasSubstr("\"tracks\": [\"slalom@1\"],\n  \"hold_out_tracks\": [\"kidney@2\"]"));
    EXPECT_THAT(run.file, testing::HasSubstr(R"("beam": {"width":8,"epochs":2)"));
    EXPECT_THAT(run.file, testing::Not(testing::HasSubstr(R"("figures_of_hold_out": {"scenes":0)")));
    EXPECT_THAT(run.summary,
                testing::AllOf(testing::StartsWith("training "), testing::HasSubstr("\nhold-out ")));
    options.hold_out = options.tracks;
    EXPECT_ANY_THROW((void)run_step_training(options));
}

}  // namespace
}  // namespace conelane::learning
