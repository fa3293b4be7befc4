// The training of `front`: its loop, its options and what it records.

#include "learning/training/front_training.hpp"

#include "evaluation/world/centre_line.hpp"
#include "evaluation/world/generated_tracks.hpp"
#include "graph_search/weights/shipped_weights.hpp"
#include "tests/support/front_fixture.hpp"
#include "tests/support/refusal.hpp"

namespace conelane::learning {
namespace {

using tests::random_front_network;
using tests::random_front_weights;

std::vector<Track> courses() {
    return {generate_track("hairpins", 1), generate_track("kidney", 2)};
}

FrontTrainingOptions quick() {
    FrontTrainingOptions options;
    options.draws_per_step = 3;
    options.scenes.scenes_per_draw = 2;
    options.imitation_steps = 6;
    options.search_steps = 6;
    options.judge_steps = 4;
    options.trust_draws = 5;
    options.report_every = 6;
    options.loss.search.beam_width = 6;
    return options;
}

TEST(FrontTraining, TrustsNoFartherThanItsShareOfScenesAllows) {
    FrontTrainingOptions options = quick();
    options.trust_draws = 20;
    const auto least_trust = [&](double trusted) {
        options.trusted = trusted;
        return train_front(courses(), {}, options, {}).least_trust;
    };
    EXPECT_EQ(least_trust(0.01), 0.0) << "nearly all lanes may be wrong";
    const double strict = least_trust(1.0);
    EXPECT_GT(strict, 0.0);
    EXPECT_LE(strict, 1.0);
    EXPECT_LE(least_trust(0.7), strict);
}

/// A training that begins with given weights and trains only the judge keeps the cost.
TEST(FrontTraining, BeginsWithTheWeightsThatAreGiven) {
    FrontTrainingOptions options = quick();
    options.imitation_steps = 0;
    options.search_steps = 0;
    options.judge_steps = 2;
    options.initial = random_front_weights(4);
    options.initial_name = "0123456789abcdef";
    const FrontWeights weights = train_front(courses(), {}, options, {});
    EXPECT_EQ(weights.extend, options.initial->extend);
    EXPECT_NE(weights.usable, options.initial->usable);
    EXPECT_THAT(describe_training(courses(), options),
                testing::HasSubstr(R"("begins_with":"0123456789abcdef")"));
    // If the training does not learn the set for colors, that set does not change.
    options.initial->colored = random_front_weights(5);
    EXPECT_EQ(train_front(courses(), {}, options, {}).colored, options.initial->colored);
    options.initial->stop.linear.pop_back();
    EXPECT_THROW((void)train_front(courses(), {}, options, {}), InvalidInput);
}

/// The networks of the judge that are not named stay as they are.
TEST(FrontTraining, LearnsTheNamedPartsOfTheJudgeAlone) {
    FrontTrainingOptions options = quick();
    options.imitation_steps = options.search_steps = 0;
    options.initial = random_front_weights(4);
    const auto changed = [&](const std::string& part) {
        options.judge_parts = {part};
        const FrontWeights weights = train_front(courses(), {}, options, {});
        std::vector<std::string> names;
        if (weights.rank != options.initial->rank) names.emplace_back("rank");
        if (weights.usable != options.initial->usable) names.emplace_back("usable");
        if (weights.right != options.initial->right) names.emplace_back("right");
        return names;
    };
    for (const std::string part : {"rank", "usable", "right"})
        EXPECT_THAT(changed(part), testing::ElementsAre(part));
    EXPECT_THAT(describe_training(courses(), options), testing::HasSubstr(R"("parts":["right"])"));
}

/// The set for colors learns the same as a training of one set that begins with the same numbers.
TEST(FrontTraining, LearnsTheSetForColorsAlone) {
    FrontTrainingOptions options = quick();
    options.imitation_steps = 0;
    options.scenes.colored_share = 1.0;
    options.initial = random_front_weights(4);
    options.only_colors = true;
    const FrontWeights weights = train_front(courses(), {}, options, {});
    const auto first_set = [](const FrontWeights& of) -> const FrontWeightSet& { return of; };
    EXPECT_EQ(first_set(weights), first_set(*options.initial));
    FrontTrainingOptions of_one_set = options;
    of_one_set.only_colors = false;
    EXPECT_EQ(weights.colored, first_set(train_front(courses(), {}, of_one_set, {})));
    EXPECT_NE(weights.colored, first_set(*options.initial));
    // It begins with the set for colors of the given weights.
    options.initial->colored = random_front_weights(5);
    options.search_steps = 0;
    options.judge_steps = 0;
    FrontWeights unchanged = train_front(courses(), {}, options, {});
    unchanged.colored.value().least_trust = options.initial->colored->least_trust;
    EXPECT_EQ(unchanged, *options.initial);
}

/// Lanes of random weights are rarely right, so the threshold depends on the drawn scenes.
TEST(FrontTraining, ChoosesTheThresholdOfTrustOnOtherCourses) {
    FrontTrainingOptions options = quick();
    options.initial = random_front_weights(4);
    options.initial->usable = random_front_network(kWholeLaneFeatures, 7);
    options.initial->right = random_front_network(kRightInputs, 8);
    options.imitation_steps = options.search_steps = options.judge_steps = 0;
    options.trusted = 0.7;
    options.trust_draws = 20;
    FrontWeights weights = train_front(courses(), {}, options, {});
    options.trust_courses = std::vector{generate_track("slalom", 5)};
    FrontWeights others = train_front(courses(), {}, options, {});
    EXPECT_NE(weights.least_trust, others.least_trust);
    others.least_trust = weights.least_trust;
    EXPECT_EQ(weights, others);
}

TEST(FrontTraining, GivesTheSameWeightsOnAnyNumberOfThreadsAndOthersFromAnotherSeed) {
    FrontTrainingOptions options = quick();
    const FrontWeights weights = train_front(courses(), {}, options, {});
    options.threads = 2;
    EXPECT_TRUE(train_front(courses(), {}, options, {}) == weights);
    options.seed = 1;
    EXPECT_FALSE(train_front(courses(), {}, options, {}) == weights);
}

TEST(FrontTraining, ResumesFromItsCheckpoint) {
    const auto folder = std::filesystem::temp_directory_path() / "conelane_front_training_test";
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    FrontTrainingOptions options = quick();
    const FrontWeights whole = train_front(courses(), {}, options, {});
    options.checkpoint = (folder / "front.checkpoint").string();
    options.checkpoint_every = 5;
    // An exception from a report ends it in the middle of the second part.
    struct Ended {};
    options.report_every = 8;
    EXPECT_THROW((void)train_front(courses(), {}, options, [](auto&&...) { throw Ended{}; }), Ended);
    std::vector<std::string> lines;
    const FrontWeights resumed = train_front(
        courses(), {}, options, [&](const std::string& line, const auto&) { lines.push_back(line); });
    EXPECT_THAT(lines.front(), testing::StartsWith("step 8 of 16")) << "gone on from step 5";
    EXPECT_TRUE(resumed == whole);
    const std::vector<SceneSet> held_out(1);
    std::size_t sets = 0;
    EXPECT_TRUE(whole == train_front(courses(), held_out, options,
                                     [&](auto&&, const auto& figures) { sets = figures.size(); }));
    EXPECT_EQ(sets, 1U) << "a training that was finished has figures too";
    options.seed = 9;
    EXPECT_THROW((void)train_front(courses(), {}, options, {}), InputError) << "another training";
    std::ofstream(options.checkpoint) << "{}";
    EXPECT_THROW((void)train_front(courses(), {}, options, {}), InputError);
    std::filesystem::remove_all(folder);
}

// `turn` is an input of the extensions, after those of the state; `width` is one of the state, the extensions
// and the start.
TEST(FrontTraining, AnInputThatIsLeftOutKeepsNoWeight) {
    FrontTrainingOptions options = quick();
    options.without = {"turn", "width"};
    const FrontWeights weights = train_front(courses(), {}, options, {});
    const auto weights_of = [](const FrontNetworkWeights& network, std::size_t input) {
        float sum = std::abs(network.linear[input]);
        for (std::size_t unit = 0; unit < kFrontUnits; ++unit)
            sum += std::abs(network.hidden[input * kFrontUnits + unit]);
        return sum;
    };
    const auto place = [](std::string_view name, auto table) {
        return static_cast<std::size_t>(std::ranges::find(table, name, &FrontFeature::name) - table.begin());
    };
    const std::size_t turn = kStateFeatures + place("turn", extend_feature_table());
    EXPECT_EQ(weights_of(weights.extend, turn), 0.0F);
    EXPECT_GT(weights_of(weights.extend, turn + 1), 0.0F);
    const std::size_t width = place("width", state_feature_table());
    EXPECT_EQ(weights_of(weights.extend, width), 0.0F);
    EXPECT_EQ(weights_of(weights.stop, width), 0.0F);
    EXPECT_EQ(weights_of(weights.start, place("width", start_feature_table())), 0.0F);
}

TEST(FrontTraining, LearnsToFindLanesOnACourseItHasNotSeen) {
    SceneOptions scenes{.false_positive_rates = {0.2}, .ranges_m = {30.0}, .every_m = 12.0};
    const SceneSet other = make_scene_set({"generated:slalom@5"}, scenes);
    FrontTrainingOptions options = quick();
    options.draws_per_step = 4;
    options.imitation_steps = 60;
    options.search_steps = 40;
    options.threads = 2;
    const FrontFigures before = front_figures(other, FrontWeights::zero(), options.loss.search, 1);
    const FrontFigures after =
        front_figures(other, train_front(courses(), {}, options, {}), options.loss.search, 1);
    EXPECT_GT(after.scenes, 10U);
    EXPECT_LT(before.iou, 0.5);
    EXPECT_GT(after.iou, 0.8);
}

TEST(FrontTraining, FiguresOfARunCountWhereItsPathShowsTheWay) {
    SceneOptions scenes{.false_positive_rates = {0.0}, .ranges_m = {30.0}, .every_m = 12.0};
    SceneSet run = make_scene_set({"generated:slalom@5"}, scenes);
    ASSERT_GT(run.scenes.size(), 5U);
    TrackBoundaries& course = run.tracks.begin()->second;
    for (const Pose& pose : centre_line_poses(course, 1.0)) course.driven.push_back(pose.position);
    course.left.clear();
    course.right.clear();
    for (AnnotatedScene& scene : run.scenes) scene.ground_truth.reset();
    run.scenes.front().scene.cones.clear();  // so nothing shows that a lane continues

    const FrontFigures figures = front_figures(run, shipped_front_weights(), {}, 1);
    EXPECT_EQ(figures.scenes, run.scenes.size() - 1);
    EXPECT_GT(figures.usable, 0.8);
    EXPECT_EQ(figures.iou, 0.0);
    EXPECT_EQ(figures.exact, 0.0);
}

TEST(FrontTraining, NamesThatAreNoneAreRefused) {
    const auto key_of = [&](auto change) {
        FrontTrainingOptions options = quick();
        change(options);
        return refused_key([&] { validate(options); });
    };
    EXPECT_EQ(key_of([](auto&) {}), "accepted");
    EXPECT_EQ(key_of([](auto& o) { o.without = {"turn", "colour"}; }), "--without");
    EXPECT_EQ(key_of([](auto& o) { o.judge_parts = {"usable", "left"}; }), "--judge-parts");
    EXPECT_EQ(key_of([](auto& o) { o.only_colors = true; }), "--only-colors");
    EXPECT_EQ(key_of([](auto& o) { o.loss.search.drop = -1.0; }), "drop");
    EXPECT_THROW((void)train_front({}, {}, quick(), {}), InvalidInput);
}

TEST(FrontTraining, ARunRecordsWhatItDependedOn) {
    FrontTrainingRunOptions options{.tracks = {"generated:slalom@1"},
                                    .hold_out = {"generated:kidney@2"},
                                    .hold_out_every_m = 60.0,
                                    .rates = {0.3},
                                    .training = quick()};
    std::vector<std::string> lines;
    const FrontTrainingRun run =
        run_front_training(options, [&](const std::string& line) { lines.push_back(line.substr(0, 16)); });
    // After 6, 12 and all 16 steps: a line of its own, and one for each condition.
    EXPECT_THAT(lines, testing::ElementsAre("step 6 of 16, mo", testing::StartsWith("  paper"),
                                            testing::StartsWith("  car"), "step 12 of 16, t", testing::_,
                                            testing::_, "step 16 of 16, j", testing::_, testing::_));
    EXPECT_THAT(run.record, testing::HasSubstr(R"("tracks":["slalom@1"])"));
    EXPECT_THAT(run.record, testing::HasSubstr(R"("hold_out_tracks":["kidney@2"])"));
    EXPECT_THAT(run.record, testing::HasSubstr(R"("beam":6)"));
    options.trust_tracks = {"generated:kidney@3"};
    EXPECT_THAT(run_front_training(options, {}).record, testing::HasSubstr(R"("trust_tracks":["kidney@3"])"));
    options.trust_tracks = options.hold_out;
    EXPECT_THROW((void)run_front_training(options, {}), InputError) << "measured on, so not chosen on";
    options.trust_tracks = options.tracks;
    EXPECT_THROW((void)run_front_training(options, {}), InputError);
    options.trust_tracks.clear();
    options.hold_out = options.tracks;
    EXPECT_THROW((void)run_front_training(options, {}), InputError);
}

}  // namespace
}  // namespace conelane::learning
