// Contract of tuning: ranges around sensible parameters, and a fit that keeps the best point.

#include "conelane/rld_parameter_sets.hpp"
#include "learning/tuning/rld_tuning.hpp"
#include "tests/support/testing.hpp"

namespace conelane::learning {
namespace {

/// Replaces scenes: the best d_e is 2.3.
double value_of_d_e(const RldParameters& parameters) {
    return 1.0 / (1.0 + std::abs(parameters.d_e - 2.3));
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

TEST(Tune, FindsTheBestAndSaysWhatItWasBefore) {
    const Tuned tuned = tune(value_of_d_e, RldParameters{}, {.evaluations = 300, .seed = 7});
    EXPECT_NEAR(tuned.parameters.d_e, 2.3, 0.05);
    EXPECT_NEAR(tuned.figure_of_start, 1.0 / 1.9, 1e-12);  // 3.2 is 0.9 off
    EXPECT_EQ(tuned.figure, value_of_d_e(tuned.parameters));
    const auto always = [](const RldParameters&) { return 0.5; };
    EXPECT_EQ(tune(always, RldParameters{}, {.evaluations = 40}).parameters.d_e, RldParameters{}.d_e)
        << "where nothing is better";
}

TEST(Tune, GivesTheSameForTheSameSeed) {
    const auto tuned_with = [](std::uint64_t seed) {
        return tune(value_of_d_e, RldParameters{}, {.evaluations = 60, .seed = seed}).parameters;
    };
    EXPECT_EQ(to_unit_cube(tuned_with(5)), to_unit_cube(tuned_with(5)));
    EXPECT_NE(to_unit_cube(tuned_with(5)), to_unit_cube(tuned_with(6)));
}

TEST(Tune, PassesOnWhatAnEvaluationThrows) {
    int calls = 0;
    const auto fails_later = [&](const RldParameters& p) {
        if (++calls > 5) throw InputError("", 0, "disk", "full");
        return value_of_d_e(p);
    };
    EXPECT_THROW(static_cast<void>(tune(fails_later, {}, {.evaluations = 30})), InputError);
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
    EvaluationOptions options;
    options.nearest = 12;
    options.time_limit_ms = 1e5;
    EXPECT_GT(Evaluation(straight_track(0.0), options)(RldParameters{}), 0.9);
    options.max_nodes = -1;
    EXPECT_EQ(Evaluation(straight_track(0.0), options)(RldParameters{}), 0.0);
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
    EvaluationOptions options;
    options.nearest = 8;
    options.time_limit_ms = 1e5;
    SceneSet set;
    set.scenes = {scene};
    set.tracks[""] = {{{-20, 1.6}, {80, 1.6}}, {{-20, -1.6}, {80, -1.6}}, false};
    EXPECT_EQ(Evaluation(set, options)(RldParameters{}), 0.0);
    options.context = 18;
    EXPECT_EQ(Evaluation(set, options)(RldParameters{}), 1.0);
}

TEST(ShippedParameters, AreValidAndFoundByName) {
    for (const std::string_view name : rld_parameter_set_names())
        EXPECT_NO_THROW(validate(rld_parameter_set(name).value())) << name;
    EXPECT_FALSE(rld_parameter_set(std::string_view("n13")));
}

}  // namespace
}  // namespace conelane::learning
