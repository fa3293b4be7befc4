// The fit of weights: the objective is linear in them, the smoothed value of the lane graph of least cost has
// the right gradient, and rounds learn only from the tracks that they are given.

#include "experiments/tuning/weight_fit.hpp"

#include "conelane/invalid_input.hpp"
#include "experiments/tuning/evaluation.hpp"
#include "experiments/tuning/tuner.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "tests/support/testing.hpp"

namespace conelane::experiments {
namespace {

SceneSet scenes_of(const std::vector<std::string>& tracks, double rate) {
    SceneOptions options{.false_positive_rates = {rate},
                         .ranges_m = {30.0},
                         .every_m = 12.0,
                         .with_color = true,
                         .color_error_rate = 0.3,
                         .with_confidence = true};
    return make_scene_set(tracks, options);
}

double weighted(const ObjectiveSums& sums, const RldParameters& parameters) {
    double sum = 0.0;
    for (std::size_t term = 0; term < kObjectiveTermCount; ++term)
        sum += parameters.*kObjectiveWeights[term] * sums[term];
    return sum;
}

TEST(ObjectiveSums, TimesTheWeightsAreTheObjective) {
    RldParameters parameters = with_shape_costs({});
    parameters.w_b = 1.3;
    parameters.w_color = 0.2;
    parameters.use_confidence = true;
    const auto solver = make_path_pair_solver();
    std::size_t solved = 0;
    for (const AnnotatedScene& annotated : scenes_of({"generated:curvy"}, 0.5).scenes) {
        const EvaluatedScene evaluated = evaluate(*solver, annotated.scene, parameters, {.nearest = 14});
        if (!evaluated.report.lane_graph) continue;
        ++solved;
        const LaneGraph& graph = *evaluated.report.lane_graph;
        ObjectiveSums sums = objective_sums(evaluated.problem, graph);
        EXPECT_NEAR(weighted(sums, parameters), objective(evaluated.problem, graph), 1e-9);
        // The sums do not depend on the weights.
        RldParameters other = parameters;
        for (double RldParameters::*weight : kObjectiveWeights) other.*weight *= 1.7;
        const ObjectiveSums again = objective_sums(make_problem(evaluated.seen, other), graph);
        for (std::size_t term = 0; term < kObjectiveTermCount; ++term)
            EXPECT_NEAR(sums[term], again[term], 1e-9);
    }
    EXPECT_GT(solved, 5U);
}

RatedGraph rated(double spacing, double facing, double value) {
    RatedGraph result;
    result.sums[static_cast<std::size_t>(ObjectiveTerm::benefit)] = -0.1 * spacing;
    result.sums[static_cast<std::size_t>(ObjectiveTerm::spacing)] = spacing;
    result.sums[static_cast<std::size_t>(ObjectiveTerm::facing)] = facing;
    result.value = value;
    return result;
}

TEST(ExpectedValue, IsHalfOfTwoThatCostTheSameAndAllOfOneThatIsFarCheaper) {
    RldParameters parameters = with_shape_costs({});
    parameters.w_s = parameters.facing_weight = 1.0;
    const std::vector<RatedGraphs> same{{rated(1.0, 0.0, 1.0), rated(1.0, 0.0, 0.0)}};
    EXPECT_DOUBLE_EQ(expected_value(same, parameters, nullptr), 0.5);
    const std::vector<RatedGraphs> cheaper{{rated(1.0, 0.0, 1.0), rated(9.0, 1.0, 0.0)}};
    EXPECT_NEAR(expected_value(cheaper, parameters, nullptr), 1.0, 1e-9);
    EXPECT_EQ(expected_value({}, parameters, nullptr), 0.0);
}

TEST(ExpectedValue, HasTheGradientOfItsDifferences) {
    const std::vector<RatedGraphs> scenes{{rated(0.3, 0.2, 1.0), rated(0.1, 0.4, 0.2), rated(0.2, 0.1, 0.0)},
                                          {rated(0.9, 0.1, 0.0), rated(0.7, 0.6, 0.7)},
                                          {rated(5.0, 5.0, 0.4)}};
    RldParameters parameters = with_shape_costs({});
    parameters.w_b = 1.5;
    ObjectiveSums gradient;
    static_cast<void>(expected_value(scenes, parameters, &gradient));
    EXPECT_EQ(gradient[0], 0.0) << "w_b is the unit";
    for (std::size_t term = 1; term < kObjectiveTermCount; ++term) {
        const auto value_at = [&](double step) {
            RldParameters moved = parameters;
            moved.*kObjectiveWeights[term] *= std::exp(step);
            return expected_value(scenes, moved, nullptr);
        };
        const double h = 1e-5;
        EXPECT_NEAR(gradient[term], (value_at(h) - value_at(-h)) / (2.0 * h), 1e-8) << term;
    }
}

/// In both scenes, the right lane has worse spacing and better facing: by 1 and 1, and by 2 and 1. Its
/// benefit is higher by 0.1 and 0.2. It is the answer in both if w_v > 2 w_s - 0.2.
TEST(FitWeights, MakesTheRightOnesCheapest) {
    const std::vector<RatedGraphs> scenes{{rated(1.0, 0.0, 1.0), rated(0.0, 1.0, 0.0)},
                                          {rated(2.0, 0.0, 1.0), rated(0.0, 1.0, 0.0)}};
    RldParameters start = with_shape_costs({});
    start.w_s = 1.0;
    start.facing_weight = 0.5;
    const RldParameters fitted = fit_weights(scenes, start);
    EXPECT_GT(fitted.facing_weight, 2.0 * fitted.w_s - 0.2);
    EXPECT_GT(expected_value(scenes, fitted, nullptr), 0.99);
    EXPECT_EQ(fitted.w_b, start.w_b);
    EXPECT_EQ(fitted.d_e, start.d_e);
}

TEST(FitWeights, StaysWhereNothingIsBetter) {
    const std::vector<RatedGraphs> scenes{{rated(1.0, 0.0, 0.5), rated(0.0, 1.0, 0.5)}};
    RldParameters start = with_shape_costs({});
    start.facing_weight = 1.2345;  // which rounding to four decimals keeps
    EXPECT_EQ(fit_weights(scenes, start).facing_weight, start.facing_weight);
    EXPECT_EQ(fit_weights({}, start).facing_weight, start.facing_weight);
}

std::vector<double> weights_of(const std::vector<RldParameters>& rounds) {
    std::vector<double> weights;
    for (const RldParameters& parameters : rounds) {
        for (double RldParameters::*weight : kObjectiveWeights) weights.push_back(parameters.*weight);
    }
    return weights;
}

TEST(WeightRounds, LearnFromTheTracksNamedAloneOnAnyNumberOfThreads) {
    EvaluationOptions options{.nearest = 12, .context = 24, .time_limit_ms = 1e5};
    const RldParameters start = with_shape_costs({});
    const std::set<std::string> tracks{"curvy"};
    std::size_t solves = 0;
    const Evaluation alone(scenes_of({"generated:curvy"}, 0.5), options);
    const auto one = fit_weights_in_rounds(alone, start, tracks, {2, 3, [&] { ++solves; }});
    ASSERT_EQ(one.size(), 2U);
    EXPECT_EQ(solves, solves_in(2));
    EXPECT_NE(weights_of({one.back()}), weights_of({start}));

    options.threads = 2;
    const Evaluation both(scenes_of({"generated:curvy", "generated:circle"}, 0.5), options);
    EXPECT_EQ(weights_of(fit_weights_in_rounds(both, start, tracks, {2, 3})), weights_of(one));
}

TEST(WeightRounds, GiveAWeightToATermThatHadNone) {
    const Evaluation evaluation(scenes_of({"generated:curvy"}, 0.5),
                                {.nearest = 12, .context = 24, .time_limit_ms = 1e5});
    RldParameters start = with_shape_costs({});
    start.unevenness_weight = 0.0;
    const auto rounds = fit_weights_in_rounds(evaluation, start, {"curvy"}, {2, 3});
    EXPECT_GE(rounds.back().unevenness_weight, 0.01) << "the lowest of its range";
}

TEST(WeightRounds, RefuseABenefitOfZero) {
    const Evaluation evaluation(scenes_of({"generated:curvy"}, 0.5), {.nearest = 12});
    RldParameters start = with_shape_costs({});
    start.w_b = 0.0;
    EXPECT_THROW(static_cast<void>(fit_weights_in_rounds(evaluation, start, {"curvy"}, {1, 3})),
                 InvalidInput);
    EXPECT_TRUE(fit_weights_in_rounds(evaluation, start, {"curvy"}, {0, 3}).empty());
}

TEST(WeightRounds, DoNotLoseWorthOnWhatTheyLearnFrom) {
    const Evaluation evaluation(scenes_of({"generated:curvy", "generated:circle"}, 0.5),
                                {.nearest = 12, .context = 24, .time_limit_ms = 1e5});
    const RldParameters start = with_shape_costs({});
    std::vector<std::set<std::string>> asked;
    const auto propose = [&](const RldParameters& from, const std::set<std::string>& tracks) {
        asked.push_back(tracks);
        return fit_weights_in_rounds(evaluation, from, tracks, {3, 5});
    };
    const Tuned tuned = tune([&](const RldParameters& p) { return evaluation(p); }, start,
                             {.folds = 2, .evaluations = 0}, propose);
    EXPECT_THAT(asked, ElementsAre(UnorderedElementsAre("circle"), UnorderedElementsAre("curvy"),
                                   UnorderedElementsAre("circle", "curvy")));
    EXPECT_GE(mean_over_scenes(tuned.laps), mean_over_scenes(tuned.laps_of_start));
}

TEST(Tune, TakesTheBestThatIsProposed) {
    const auto evaluate = [](const RldParameters& p) {
        return std::vector<LapFigure>{{"track", 0.0, 30.0, 1, 1.0 / (1.0 + std::abs(p.d_e - 2.3))}};
    };
    const auto propose = [](RldParameters parameters, const std::set<std::string>&) {
        std::vector<RldParameters> proposed;
        for (const double d_e : {4.0, 2.4, 1.8}) {
            parameters.d_e = d_e;
            proposed.push_back(parameters);
        }
        return proposed;
    };
    EXPECT_EQ(tune(evaluate, {}, {.folds = 1, .evaluations = 0}, propose).parameters.d_e, 2.4);
    EXPECT_NEAR(tune(evaluate, {}, {.folds = 1, .evaluations = 80}, propose).parameters.d_e, 2.3, 0.05);
}

}  // namespace
}  // namespace conelane::experiments
