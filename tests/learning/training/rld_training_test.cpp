#include "learning/training/rld_training.hpp"

#include "conelane/invalid_input.hpp"
#include "conelane/rld_parameter_sets.hpp"
#include "evaluation/formats/track_spec.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "tests/support/learned_costs.hpp"
#include "tests/support/random_scenes.hpp"

#include <iterator>

namespace conelane::learning {
namespace {

std::vector<Track> courses() {
    std::vector<Track> all = load_tracks("generated:kidney@4");
    std::ranges::move(load_tracks("generated:hairpins@2"), std::back_inserter(all));
    return all;
}

RldTrainingOptions quick() {
    RldTrainingOptions options;
    options.units = 3;
    options.steps = 12;
    options.draws_per_step = 2;
    options.scenes.scenes_per_draw = 2;
    options.max_work = 2'000'000;
    options.report_every = 5;
    return options;
}

/// The training begins with the set `shape`: with its limits, the same lane graphs are optimal.
TEST(RldTraining, BeginsWithTheOptimaOfShape) {
    const RldParameters shape = rld_parameter_set("shape").value();
    RldParameters learned = shape;
    for (double RldParameters::*const weight :
         {&RldParameters::w_s, &RldParameters::w_t, &RldParameters::w_p, &RldParameters::w_b,
          &RldParameters::unevenness_weight, &RldParameters::facing_weight,
          &RldParameters::near_end_weight}) {
        learned.*weight = 0.0;
    }
    learned.learned_costs = std::make_shared<const LearnedCosts>(as_learned_costs(shape));
    const auto solver = make_path_pair_solver();
    int lanes = 0;
    int same = 0;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        const Scene scene = tests::random_scene(seed, 12);
        const LaneGraphProblem problem = make_problem(scene, shape);
        const RldReport of_shape = solver->solve(problem, {});
        const RldReport of_learned = solver->solve(make_problem(scene, learned), {});
        ASSERT_EQ(of_shape.status, of_learned.status);
        if (!of_shape.lane_graph) continue;
        ++lanes;
        // Heading costs above 4 and unevenness above 4 are cut: then the optima may differ.
        if (std::abs(objective(problem, *of_learned.lane_graph) - *of_shape.objective) < 1e-9) ++same;
    }
    EXPECT_GT(lanes, 40);
    EXPECT_GE(same, lanes - 2);
}

/// Derivatives of a lane graph's cost by each number, from differences of two costs.
TEST(RldTraining, TheGradientOfACostIsThatOfItsDifferences) {
    int compared = 0;
    for (std::uint64_t seed = 0; seed < 14; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene = tests::random_scene(seed, 10);
        RldParameters parameters;
        LearnedCosts costs = *tests::random_learned_costs(seed, 4);
        // Away from the limits, where the derivative does not exist.
        costs.of(LearnedPart::turn).linear[0] += 60.0;
        costs.of(LearnedPart::near_end).linear[0] -= 60.0;
        costs.of(LearnedPart::far_end).linear[0] -= 60.0;
        const auto problem_with = [&](const LearnedCosts& with) {
            RldParameters own = parameters;
            own.learned_costs = std::make_shared<const LearnedCosts>(with);
            return make_problem(scene, own);
        };
        const LaneGraphProblem problem = problem_with(costs);
        const RldReport best = make_path_pair_solver()->solve(problem, {});
        if (!best.lane_graph) continue;
        const LearnedFeatures features(scene, problem);
        LearnedCosts gradient = LearnedCosts::zero(4);
        add_cost_gradient(problem, features, *best.lane_graph, 2.0, gradient);
        const Eigen::ArrayXd at = flat(costs);
        const Eigen::ArrayXd derivatives = flat(gradient);
        constexpr double kStep = 1e-6;
        for (Eigen::Index i = 0; i < at.size(); i += 3) {
            Eigen::ArrayXd moved = at;
            moved[i] += kStep;
            LearnedCosts above = costs;
            set(above, moved);
            moved[i] -= 2.0 * kStep;
            LearnedCosts below = costs;
            set(below, moved);
            const double difference = objective(problem_with(above), *best.lane_graph) -
                                      objective(problem_with(below), *best.lane_graph);
            EXPECT_NEAR(derivatives[i], 2.0 * difference / (2.0 * kStep), 1e-4) << "number " << i;
            ++compared;
        }
    }
    EXPECT_GT(compared, 100);
}

/// A turn that would gain costs 0: a step may raise it, but not lower it further.
TEST(RldTraining, WhatALimitHoldsIsPushedOnlyAwayFromIt) {
    LearnedCosts costs = as_learned_costs(with_shape_costs({}));
    costs.of(LearnedPart::turn).linear[0] = -50.0;
    costs.of(LearnedPart::far_end).linear[0] = 50.0;
    RldParameters parameters{.learned_costs = std::make_shared<const LearnedCosts>(costs)};
    Scene scene;
    LaneGraphProblem problem;
    RldReport best;
    for (std::uint64_t seed = 0; !best.lane_graph && seed < 20; ++seed) {
        scene = tests::random_scene(seed, 10);
        problem = make_problem(scene, parameters);
        best = make_path_pair_solver()->solve(problem, {});
    }
    ASSERT_TRUE(best.lane_graph);
    ASSERT_GT(best.lane_graph->edges.size(), 2U) << "there is a turn";
    const LearnedFeatures features(scene, problem);
    for (const double factor : {1.0, -1.0}) {
        LearnedCosts gradient = LearnedCosts::zero(0);
        add_cost_gradient(problem, features, *best.lane_graph, factor, gradient);
        const double turns = gradient.of(LearnedPart::turn).linear[0];
        const double ends = gradient.of(LearnedPart::far_end).linear[0];
        EXPECT_EQ(turns != 0.0, factor < 0.0);
        EXPECT_EQ(ends, factor > 0.0 ? 2.0 : 0.0);
    }
}

TEST(RldTraining, LowersTheLossOfAScene) {
    const FrontScenes scenes(courses(), quick().scenes, 1);
    RldParameters parameters = rld_learning_parameters();
    LearnedCosts costs = with_hidden_units(as_learned_costs(with_shape_costs({})), 2, 1);
    RldTrainingOptions options;
    options.max_work = 5'000'000;
    RldLearner learner(options);
    int lowered = 0;
    int tried = 0;
    int allowed = 0;
    for (std::uint64_t number = 0; number < 30 && tried < 10; ++number) {
        for (const AnnotatedScene& scene : scenes.draw(number).scenes) {
            LearnedCosts gradient = LearnedCosts::zero(2);
            parameters.learned_costs = std::make_shared<const LearnedCosts>(costs);
            const CostLoss loss = learner.add(scene, parameters, gradient);
            allowed += loss.allowed ? 1 : 0;
            if (!loss.allowed || loss.found || loss.loss < 0.1) continue;
            ++tried;
            LearnedCosts next = costs;
            set(next, flat(costs) - 1e-4 * flat(gradient));
            parameters.learned_costs = std::make_shared<const LearnedCosts>(next);
            LearnedCosts ignored = LearnedCosts::zero(2);
            if (learner.add(scene, parameters, ignored).loss < loss.loss) ++lowered;
        }
    }
    EXPECT_GT(allowed, 10);
    EXPECT_GE(tried, 5);
    EXPECT_GE(lowered, tried - 1);
}

/// What the training has not seen has no weight: colours and confidences change no cost.
TEST(RldTraining, CostsLearnedWithoutColorsDoNotDependOnThem) {
    RldTrainingOptions options = quick();
    ASSERT_GT(options.units, 0U);
    const LearnedCosts costs = train_rld(courses(), options, {});
    const auto features = learned_features(LearnedPart::edge);
    std::vector<double> plain(features.size(), 0.3);
    std::vector<double> colored = plain;
    for (std::size_t i = 0; i < features.size(); ++i) {
        const std::string_view name = features[i].name;
        if (name == "color_cost" || name == "same_color" || name == "doubt") plain[i] = 0.0;
    }
    EXPECT_NE(plain, colored);
    EXPECT_EQ(costs.of(LearnedPart::edge)(plain), costs.of(LearnedPart::edge)(colored));
}

TEST(RldTraining, GivesTheSameCostsOnAnyNumberOfThreadsAndOthersFromAnotherSeed) {
    RldTrainingOptions options = quick();
    std::vector<std::string> lines;
    const LearnedCosts costs =
        train_rld(courses(), options, [&](const std::string& line) { lines.push_back(line.substr(0, 11)); });
    EXPECT_THAT(lines, testing::ElementsAre("step 5 of 1", "step 10 of ", "step 12 of "));
    EXPECT_FALSE(costs == with_hidden_units(as_learned_costs(quick().start), 3, 0));
    options.threads = 2;
    EXPECT_TRUE(train_rld(courses(), options, {}) == costs);
    options.seed = 1;
    EXPECT_FALSE(train_rld(courses(), options, {}) == costs);
}

/// Without a step, the result is the input, with hidden units that change almost nothing.
TEST(RldTraining, BeginsWithTheCostsOfTheParameters) {
    RldTrainingOptions options = quick();
    options.steps = 0;
    options.parameters.learned_costs = tests::random_learned_costs(5, 0);
    const LearnedCosts costs = train_rld(courses(), options, {});
    for (const LearnedPart part : kLearnedParts) {
        EXPECT_EQ(costs.of(part).linear, options.parameters.learned_costs->of(part).linear);
        EXPECT_EQ(costs.of(part).units(), 3U);
        const std::vector<double> ones(costs.of(part).linear.size(), 1.0);
        EXPECT_NEAR(costs.of(part)(ones), options.parameters.learned_costs->of(part)(ones), 0.5);
    }
    options.parameters.learned_costs = tests::random_learned_costs(5, 3);
    EXPECT_TRUE(train_rld(courses(), options, {}) == *options.parameters.learned_costs);
    options.units = 4;
    EXPECT_THROW((void)train_rld(courses(), options, {}), InvalidInput);
    options = quick();
    options.parameters.d_t = -1.0;
    EXPECT_THROW((void)train_rld(courses(), options, {}), InvalidInput);
}

}  // namespace
}  // namespace conelane::learning
