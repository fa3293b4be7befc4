// Contract of tuning: ranges around sensible parameters, fits that keep the best point, folds that do not see
// their held-out tracks, and a log from which a stopped run resumes.

#include "conelane/rld_parameter_sets.hpp"
#include "evaluation/input_error.hpp"
#include "experiments/tuning/evaluation.hpp"
#include "experiments/tuning/evaluation_log.hpp"
#include "experiments/tuning/failure_causes.hpp"
#include "experiments/tuning/parameter_ranges.hpp"
#include "experiments/tuning/tuner.hpp"
#include "tests/support/file_test.hpp"
#include "tests/support/testing.hpp"

namespace conelane::experiments {
namespace {

/// Replaces scenes: each track is best at its own d_e; its value falls with the distance of d_e from it.
std::vector<LapFigure> value_by_d_e(const RldParameters& parameters, const std::vector<double>& best_d_e) {
    std::vector<LapFigure> laps;
    for (std::size_t i = 0; i < best_d_e.size(); ++i) {
        const double off = std::abs(parameters.d_e - best_d_e[i]);
        laps.push_back({"track" + std::to_string(i), 0.0, 30.0, 10, 10.0 / (1.0 + off)});
    }
    return laps;
}

TEST(ParameterRanges, LeadToThePointAndBackAndMoveValuesOutsideToTheBorder) {
    RldParameters start{.s_crit = 8.0};
    for (const RldParameters& from : {start, with_shape_costs(start)}) {
        const RldParameters back = from_unit_cube(to_unit_cube(from), from);
        for (const TunedParameter& tuned : tuned_parameters(from))
            EXPECT_NEAR(back.*tuned.value, from.*tuned.value, 1e-4) << tuned.key;
        EXPECT_EQ(back.w_b, from.w_b);
    }
    start.s_crit = 1.0;
    start.d_min = 3.5;
    const RldParameters back = from_unit_cube(to_unit_cube(start), start);
    EXPECT_EQ(back.s_crit, 7.0);
    EXPECT_EQ(back.d_min, 2.8);
}

TEST(ParameterRanges, MovesTheShapeCostsOfAStartThatHasThemAndKeepsItsLimits) {
    const auto highest = [](const RldParameters& start) {
        return from_unit_cube(std::vector<double>(tuned_parameters(start).size(), 1.0), start);
    };
    const RldParameters plain = highest({});
    EXPECT_FALSE(has_shape_costs(plain));
    EXPECT_EQ(plain.d_near, 12.0);
    const RldParameters shaped = highest(with_shape_costs({}));
    EXPECT_EQ(shaped.unevenness_weight, 3.0);
    EXPECT_EQ(shaped.w_s, plain.w_s);
    EXPECT_EQ(shaped.d_near, RldParameters{}.d_near);
    EXPECT_EQ(shaped.s_crit, 7.0) << "a limit below its range";
}

TEST(ParameterRanges, HoldsValidParametersAtItsCornersAndKeepsTheRest) {
    RldParameters rest{.d_t = 1.25, .pairing = Pairing::paper};
    for (const double corner : {0.0, 1.0}) {
        const std::vector<double> point(tuned_parameters(rest).size(), corner);
        const RldParameters parameters = from_unit_cube(point, rest);
        EXPECT_NO_THROW(validate(parameters));
        EXPECT_EQ(parameters.d_t, 1.25);
        EXPECT_EQ(parameters.pairing, Pairing::paper);
    }
}

TEST(Tune, FindsTheBestOfATrackAndSaysWhatItWasBefore) {
    const auto evaluate = [](const RldParameters& parameters) { return value_by_d_e(parameters, {2.3}); };
    const Tuned tuned = tune(evaluate, RldParameters{}, {.folds = 1, .evaluations = 300, .seed = 7});
    EXPECT_NEAR(tuned.parameters.d_e, 2.3, 0.05);
    EXPECT_NEAR(mean_over_scenes(tuned.laps_of_start), 1.0 / 1.9, 1e-12);  // 3.2 is 0.9 off
    EXPECT_TRUE(tuned.folds.empty());
    const auto always = [](const RldParameters&) {
        return std::vector<LapFigure>{{"track", 0.0, 30.0, 4, 2.0}};
    };
    EXPECT_EQ(tune(always, RldParameters{}, {.folds = 1, .evaluations = 40}).parameters.d_e,
              RldParameters{}.d_e)
        << "where nothing is better";
}

TEST(Tune, FitsAFoldToTheOtherTracksAlone) {
    // Tracks 0 and 2 are best at 2, tracks 1 and 3 at 4: a fold is fitted to the tracks that it learns from.
    const auto evaluate = [](const RldParameters& p) { return value_by_d_e(p, {2.0, 4.0, 2.0, 4.0}); };
    const Tuned tuned = tune(evaluate, RldParameters{}, {.folds = 2, .evaluations = 300, .seed = 3});
    ASSERT_EQ(tuned.folds.size(), 2U);
    EXPECT_THAT(tuned.folds[0].held_out, ElementsAre("track0", "track2"));
    EXPECT_NEAR(tuned.folds[0].parameters.d_e, 4.0, 0.05);
    EXPECT_NEAR(tuned.folds[1].parameters.d_e, 2.0, 0.05);
    EXPECT_NEAR(mean_over_scenes(tuned.folds[0].held_out_laps), 1.0 / 3.0, 0.02);  // 4 is 2 off
}

TEST(Tune, GivesTheSameForTheSameSeed) {
    const auto tuned_with = [](std::uint64_t seed) {
        const auto evaluate = [](const RldParameters& p) { return value_by_d_e(p, {2.3, 3.9}); };
        return tune(evaluate, RldParameters{}, {.folds = 1, .evaluations = 60, .seed = seed}).parameters;
    };
    EXPECT_EQ(to_unit_cube(tuned_with(5)), to_unit_cube(tuned_with(5)));
    EXPECT_NE(to_unit_cube(tuned_with(5)), to_unit_cube(tuned_with(6)));
}

TEST(Tune, PassesOnWhatAnEvaluationThrowsAndRefusesMoreFoldsThanTracks) {
    int calls = 0;
    const auto fails_later = [&](const RldParameters& p) {
        if (++calls > 5) throw InputError("", 0, "disk", "full");
        return value_by_d_e(p, {2.0});
    };
    EXPECT_THROW(static_cast<void>(tune(fails_later, {}, {.folds = 1, .evaluations = 30})), InputError);
    const auto evaluate = [](const RldParameters& p) { return value_by_d_e(p, {2.0}); };
    EXPECT_ANY_THROW(static_cast<void>(tune(evaluate, {}, {.folds = 2, .evaluations = 1})));
}

class TuningLog : public FileTest {};

TEST_F(TuningLog, RemembersAcrossRunsAndDropsALineCutShort) {
    int calls = 0;
    const auto evaluate = [&](const RldParameters& p) {
        ++calls;
        return value_by_d_e(p, {1.0 / 3.0});
    };
    RldParameters other{.d_e = 2.0 / 3.0};
    std::vector<LapFigure> first;
    {
        EvaluationLog log(path("log"), R"({"seed":1})", evaluate);
        first = log(RldParameters{});
        EXPECT_EQ(log(RldParameters{}), first);
        EXPECT_EQ(calls, 1);
    }
    std::ofstream(path("log"), std::ios::app) << R"({"parameters":{"d_e":)";
    EvaluationLog log(path("log"), R"({"seed":1})", evaluate);
    EXPECT_EQ(log(RldParameters{}), first);
    EXPECT_EQ(calls, 1);
    static_cast<void>(log(other));
    EXPECT_EQ(calls, 2);
    EXPECT_EQ(log.evaluations(), 2U);
    EXPECT_THROW(EvaluationLog(path("log"), R"({"seed":2})", evaluate), InputError);
}

TEST_F(TuningLog, AFileThatIsNoLogStaysAsItIs) {
    const auto evaluate = [](const RldParameters&) { return std::vector<LapFigure>{}; };
    for (const std::string text : {"notes without a line feed", "notes\nof two lines", R"({"seed":1} )"}) {
        std::ofstream(path("log")) << text;
        EXPECT_THROW(EvaluationLog(path("log"), R"({"seed":1})", evaluate), InputError) << text;
        std::ifstream file(path("log"));
        EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), text);
    }
    std::ofstream(path("log")) << R"({"se)";  // stopped while the header was written
    EXPECT_NO_THROW(EvaluationLog(path("log"), R"({"seed":1})", evaluate));
}

SceneSet straight_track(double rate) {
    SceneOptions options{.false_positive_rates = {rate}, .ranges_m = {30.0}, .every_m = 8.0};
    return make_scene_set({"generated:straight"}, options);
}

TEST(Evaluation, IsTheSameForAnyNumberOfThreads) {
    EvaluationOptions options{.nearest = 12, .time_limit_ms = 1e5};
    const Evaluation one(straight_track(0.3), options);
    options.threads = 2;
    const Evaluation two(straight_track(0.3), options);
    EXPECT_EQ(one(RldParameters{}), two(RldParameters{}));
}

TEST(Evaluation, CountsSlowScenesAsWorthless) {
    EvaluationOptions options{.nearest = 12, .time_limit_ms = 1e5};
    EXPECT_GT(mean_over_scenes(Evaluation(straight_track(0.0), options)(RldParameters{})), 0.9);
    options.max_nodes = -1;
    EXPECT_EQ(mean_over_scenes(Evaluation(straight_track(0.0), options)(RldParameters{})), 0.0);
}

TEST(FailureCauses, NameTheConstraintThatTheGroundTruthBreaks) {
    const SceneSet set = straight_track(0.0);
    const AnnotatedScene& scene = set.scenes.front();
    const auto cause = [&](auto change) {
        RldParameters parameters;
        change(parameters);
        return diagnose(scene, parameters, {.nearest = 12, .time_limit_ms = 1e5}).cause;
    };
    EXPECT_EQ(cause([](RldParameters&) {}), FailureCause::accurate);
    EXPECT_EQ(cause([](RldParameters& p) { p.s_crit = 0.0; }), FailureCause::breaks_spacing);
    EXPECT_EQ(cause([](RldParameters& p) { p.t_crit = 0.0; }), FailureCause::breaks_angle);
    EXPECT_EQ(cause([](RldParameters& p) { p.d_min = 30.0; }), FailureCause::breaks_width);
    EXPECT_EQ(cause([](RldParameters& p) { p.d_h = 0.0; }), FailureCause::breaks_heading);
    EXPECT_EQ(cause([](RldParameters& p) { p.d_max = 0.0; }), FailureCause::breaks_endpoints);
}

/// Cones every 4 m on both sides, and on the left a false positive in the middle of each gap. At an expected
/// spacing of 2 m, the lane of least cost contains all of them: it has two edges more than the ground truth,
/// and w_s (2 / 1.7)^4 = 1.92 w_s less spacing cost for each gap.
TEST(FailureCauses, NameTheTermInWhichTheGroundTruthIsDearest) {
    AnnotatedScene scene;
    scene.scene.id = "every_gap_halved";
    for (const ConeId i : {0, 1, 2}) {
        scene.scene.cones.push_back({i, {1.0 + 4.0 * static_cast<double>(i), 1.5}});
        scene.scene.cones.push_back({10 + i, {1.0 + 4.0 * static_cast<double>(i), -1.5}});
    }
    scene.scene.cones.push_back({20, {3.0, 1.5}});
    scene.scene.cones.push_back({21, {7.0, 1.5}});
    scene.ground_truth = Lane{{0, 1, 2}, {10, 11, 12}};
    RldParameters parameters{.d_e = 2.0};
    EXPECT_EQ(diagnose(scene, parameters, {.time_limit_ms = 1e5}).cause, FailureCause::cheaper_benefit);
    parameters.w_s = 0.6;
    EXPECT_EQ(diagnose(scene, parameters, {.time_limit_ms = 1e5}).cause, FailureCause::cheaper_spacing);
    parameters.d_e = 4.0;
    EXPECT_EQ(diagnose(scene, parameters, {.time_limit_ms = 1e5}).cause, FailureCause::accurate);
}

TEST(FailureCauses, SayWhereWrongConesAre) {
    const Lane truth{{1, 2, 3, 4}, {11, 12, 13}};
    EXPECT_EQ(wrong_cones(truth, truth), WrongCones{});
    // Left: 9 before 2 instead of 1, 8 instead of 3 inside; right: ends one too early.
    EXPECT_EQ(wrong_cones({{9, 2, 8, 4}, {11, 12}}, truth),
              (WrongCones{.near_end = 2, .inside = 2, .far_end = 1}));
    EXPECT_EQ(wrong_cones({{1, 2, 3, 4, 5, 6}, {7, 8}}, truth),
              (WrongCones{.far_end = 2, .on_lost_boundary = 5}));
}

/// The last cones of the cone set are false, in line with both boundaries, nearer than true ones behind.
TEST(Evaluation, WithContextSeesBeyondTheConeSet) {
    AnnotatedScene scene;
    scene.scene.id = "false_cone_at_the_end";
    scene.scene.pose.position = {-1, 0};
    for (int i = 0; i < 8; ++i) {
        scene.scene.cones.push_back({.id = 1 + i, .position = {3.2 * i, 1.6}});
        scene.scene.cones.push_back({.id = 101 + i, .position = {3.2 * i, -1.6}});
    }
    scene.scene.cones.push_back({.id = 200, .position = {8.6, 2.9}});
    scene.scene.cones.push_back({.id = 201, .position = {8.6, -2.9}});
    scene.ground_truth = Lane{{1, 2, 3, 4, 5, 6, 7, 8}, {101, 102, 103, 104, 105, 106, 107, 108}};
    EvaluationOptions options{.nearest = 8, .time_limit_ms = 1e5};
    const RldParameters parameters;
    const Diagnosis without = diagnose(scene, parameters, options);
    EXPECT_NE(without.cause, FailureCause::accurate);
    ASSERT_TRUE(without.wrong);
    EXPECT_EQ(without.wrong->far_end, 2U);
    options.context = 18;
    EXPECT_EQ(diagnose(scene, parameters, options).cause, FailureCause::accurate);
    SceneSet set;
    set.scenes = {scene};
    set.tracks[""] = {{{-20, 1.6}, {80, 1.6}}, {{-20, -1.6}, {80, -1.6}}, false};
    EXPECT_EQ(mean_over_scenes(Evaluation(set, options)(parameters)), 1.0);
}

TEST(ShippedParameters, AreValidAndFoundByName) {
    for (const std::string_view name : rld_parameter_set_names())
        EXPECT_NO_THROW(validate(rld_parameter_set(name).value())) << name;
    EXPECT_FALSE(rld_parameter_set(std::string_view("n13")));
}

}  // namespace
}  // namespace conelane::experiments
