// How the weights of `front` are learned: gradients, scenes, the loop and its files.

#include "experiments/training/front_training.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/files/front_weights_file.hpp"
#include "evaluation/files/input_error.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/tracks/centre_line.hpp"
#include "evaluation/tracks/generated_tracks.hpp"
#include "experiments/training/front_checkpoint.hpp"
#include "experiments/training/front_gradient.hpp"
#include "experiments/training/front_training_run.hpp"
#include "graph_search/weights/shipped_weights.hpp"
#include "tests/support/front_fixture.hpp"
#include "tests/support/test_paths.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <ranges>
#include <set>
#include <sstream>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

using tests::random_front_weights;

std::vector<Track> courses() {
    return {generate_track("hairpins", 1), generate_track("kidney", 2)};
}

FrontNetworkWeights random_network(std::size_t inputs, std::uint64_t seed) {
    boost::random::mt19937_64 random(seed);
    boost::random::normal_distribution<float> any(0.0F, 0.3F);
    FrontNetworkWeights network = FrontNetworkWeights::zero(inputs);
    for (std::vector<float>* numbers :
         {&network.hidden, &network.hidden_bias, &network.output, &network.linear})
        for (float& number : *numbers) number = any(random);
    return network;
}

FrontTrainingOptions quick() {
    FrontTrainingOptions options;
    options.draws_per_step = 3;
    options.scenes.scenes_per_draw = 2;
    options.imitation_steps = 6;
    options.search_steps = 6;
    options.judge_steps = 4;
    options.trust_draws = 5;
    options.figures_every = 6;
    options.loss.search.beam_width = 6;
    return options;
}

TEST(FrontGradient, AgreesWithFiniteDifferences) {
    FrontNetworkWeights network = random_front_weights(1).stop;
    const std::vector<float> inputs = [] {
        std::vector<float> x(kStopInputs);
        for (std::size_t i = 0; i < x.size(); ++i)
            x[i] = static_cast<float>(std::sin(1.0 + static_cast<double>(i)));
        return x;
    }();
    FrontNetworkWeights derivatives = FrontNetworkWeights::zero(kStopInputs);
    add_derivatives(network, inputs, 2.0F, derivatives);
    // Across a kink of max(0, x), a difference is not a derivative; so small a step rarely crosses one.
    constexpr float kStep = 1e-3F;
    const auto check = [&](float& weight, float derivative) {
        const float kept = weight;
        weight = kept + kStep;
        const float above = FrontNetwork(network).score(inputs);
        weight = kept - kStep;
        const float below = FrontNetwork(network).score(inputs);
        weight = kept;
        EXPECT_NEAR(2.0F * (above - below) / (2.0F * kStep), derivative, 0.02F);
    };
    for (std::size_t i = 0; i < network.hidden.size(); i += 7)
        check(network.hidden[i], derivatives.hidden[i]);
    for (std::size_t i = 0; i < kFrontUnits; ++i) {
        check(network.hidden_bias[i], derivatives.hidden_bias[i]);
        check(network.output[i], derivatives.output[i]);
    }
    for (std::size_t i = 0; i < kStopInputs; ++i) check(network.linear[i], derivatives.linear[i]);
    check(network.output_bias, derivatives.output_bias);
}

/// The loss of a scene falls along its gradient by the amount that the gradient predicts.
TEST(FrontLearner, ItsDerivativesAreThoseOfTheLoss) {
    const FrontScenes scenes(courses(), {}, 3);
    const FrontScenes::Drawn drawn = scenes.draw(5);
    ASSERT_FALSE(drawn.scenes.empty());
    FrontWeights weights = random_front_weights(2);
    for_each_block(weights, [](std::span<float> block) {
        for (float& number : block) number *= 0.3F;
    });
    FrontLearner learner;
    const auto loss_of = [&](const FrontWeights& at, FrontWeights& derivatives) {
        FrontCost cost(at);
        return learner.imitate(drawn.scenes.front(), at, cost, {}, derivatives).sum;
    };
    FrontWeights derivatives = FrontWeights::zero();
    (void)loss_of(weights, derivatives);
    double squared = 0.0;
    for_each_block(std::as_const(derivatives), [&](std::span<const float> block) {
        for (const float number : block) squared += static_cast<double>(number) * static_cast<double>(number);
    });
    ASSERT_GT(squared, 0.0);
    const auto step_by = [&](double step) {
        FrontWeights moved = derivatives;
        for_each_block(moved, [&](std::span<float> block) {
            for (float& number : block) number *= static_cast<float>(step / std::sqrt(squared));
        });
        add(moved, weights);
        FrontWeights ignored = FrontWeights::zero();
        return loss_of(moved, ignored);
    };
    constexpr double kStep = 1e-3;
    const double slope = (step_by(kStep) - step_by(-kStep)) / (2.0 * kStep);
    EXPECT_NEAR(slope / std::sqrt(squared), 1.0, 0.02);
}

/// So does the loss of the judge, for each network alone; `right` is an input of the others.
TEST(FrontJudgeLearner, ItsDerivativesAreThoseOfTheLoss) {
    const FrontScenes scenes(courses(), {}, 3);
    const FrontScenes::Drawn drawn = scenes.draw(5);
    ASSERT_FALSE(drawn.scenes.empty());
    FrontWeights weights = random_front_weights(2);
    for_each_block(weights, [](std::span<float> block) {
        for (float& number : block) number *= 0.3F;
    });
    weights.rank = weights.usable = random_network(kWholeLaneFeatures, 7);
    weights.right = random_network(kRightInputs, 8);
    FrontJudgeLossOptions options;
    options.listwise = 0.0;  // the sum does not include it
    FrontJudgeLearner learner;
    const auto loss_of = [&](const FrontWeights& at, FrontWeights* derivatives) {
        FrontCost cost(at);
        FrontJudge judge(at);
        return learner.judge(drawn.scenes.front(), drawn.boundaries, at, cost, judge, options, derivatives)
            .sum;
    };
    FrontWeights derivatives = FrontWeights::zero();
    ASSERT_GT(loss_of(weights, &derivatives), 0.0);
    for (auto network : {&FrontWeights::rank, &FrontWeights::usable}) {
        const FrontNetworkWeights& slopes = derivatives.*network;
        const auto step_by = [&](float step) {
            FrontWeights moved = weights;
            for (std::size_t i = 0; i < slopes.linear.size(); ++i)
                (moved.*network).linear[i] += step * slopes.linear[i];
            return loss_of(moved, nullptr);
        };
        double squared = 0.0;
        for (const float slope : slopes.linear)
            squared += static_cast<double>(slope) * static_cast<double>(slope);
        ASSERT_GT(squared, 0.0);
        const auto step = static_cast<float>(0.01 / std::sqrt(squared));
        const double slope = (step_by(step) - step_by(-step)) / (2.0 * static_cast<double>(step));
        EXPECT_NEAR(slope / squared, 1.0, 0.02);
    }
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

/// Half of the draws have colors, with every kind of fault; their geometry is the same as without.
TEST(FrontScenes, HalfOfTheDrawsShowColorsThatMayBeWrongOrMissing) {
    const FrontScenes colored(courses(), {}, 3);
    FrontSceneOptions without;
    without.colored_share = 0.0;
    const FrontScenes plain(courses(), without, 3);
    std::size_t draws = 0;
    std::size_t with_color = 0;
    double own = 0.0;
    double wrong = 0.0;
    double unseen = 0.0;
    double soft = 0.0;
    for (std::uint64_t number = 0; number < 200; ++number) {
        const FrontScenes::Drawn drawn = colored.draw(number);
        const FrontScenes::Drawn bare = plain.draw(number);
        ASSERT_EQ(drawn.scenes.size(), bare.scenes.size());
        if (drawn.scenes.empty()) continue;
        ++draws;
        bool any = false;
        for (std::size_t i = 0; i < drawn.scenes.size(); ++i) {
            const std::vector<Cone>& cones = drawn.scenes[i].scene.cones;
            ASSERT_NO_THROW(validate(drawn.scenes[i].scene));
            const Lane& truth = *drawn.scenes[i].ground_truth;
            for (std::size_t k = 0; k < cones.size(); ++k) {
                ASSERT_EQ(cones[k].position, bare.scenes[i].scene.cones[k].position);
                ASSERT_EQ(bare.scenes[i].scene.cones[k].color, ConeColor::unknown);
                any = any || cones[k].color != ConeColor::unknown;
                const bool on_left = std::ranges::find(truth.left, cones[k].id) != truth.left.end();
                if (!on_left) continue;
                own += cones[k].color == ConeColor::blue ? 1.0 : 0.0;
                wrong += cones[k].color == ConeColor::yellow ? 1.0 : 0.0;
                unseen += cones[k].color == ConeColor::unknown ? 1.0 : 0.0;
                soft += cones[k].color_probabilities ? 1.0 : 0.0;
            }
        }
        with_color += any ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(with_color) / static_cast<double>(draws), 0.5, 0.12);
    const double seen = own + wrong;
    EXPECT_NEAR(wrong / seen, 0.75 * 0.35 / 2.0, 0.06);
    EXPECT_GT(unseen, seen);  // half of the draws, and a fifth of the others
    EXPECT_NEAR(soft / seen, 0.3, 0.12);
}

/// A fifth of the draws has a scene of false cones only.
TEST(FrontScenes, SomeDrawsHaveASceneOfFalseConesAlone) {
    const FrontScenes scenes(courses(), {}, 3);
    std::size_t noisy = 0;
    for (std::uint64_t number = 0; number < 200; ++number) {
        const FrontScenes::Drawn drawn = scenes.draw(number);
        noisy += drawn.noise.size();
        for (const Scene& scene : drawn.noise) {
            EXPECT_NO_THROW(validate(scene));
            EXPECT_GE(scene.cones.size(), 4U);
            EXPECT_LE(scene.cones.size(), 60U);
        }
    }
    EXPECT_NEAR(static_cast<double>(noisy) / 200.0, 0.2, 0.08);
}

TEST(FrontScenes, ScenesOfFalseConesHaveTheShareCountsAndRangesThatAreGiven) {
    FrontSceneOptions options;
    options.scenes_per_draw = 1;
    options.noise_share = 0.7;
    options.noise_cones = {8, 12};
    options.noise_ranges_m = {15.0, 20.0};
    const FrontScenes scenes(courses(), options, 3);
    std::set<std::size_t> counts;
    double farthest_m = 0.0;
    std::size_t noisy = 0;
    for (std::uint64_t number = 0; number < 200; ++number) {
        for (const Scene& scene : scenes.draw(number).noise) {
            ++noisy;
            counts.insert(scene.cones.size());
            for (const Cone& cone : scene.cones) farthest_m = std::max(farthest_m, cone.position.norm());
        }
    }
    EXPECT_NEAR(static_cast<double>(noisy) / 200.0, 0.7, 0.1);
    EXPECT_THAT(counts, testing::ElementsAre(8U, 9U, 10U, 11U, 12U));
    EXPECT_LE(farthest_m, 20.0);
    EXPECT_GT(farthest_m, 19.0);
    options.noise_ranges_m = {17.0, 17.0};
    const FrontScenes of_one_range(courses(), options, 3);
    for (std::uint64_t number = 0; number < 20; ++number) {
        for (const Scene& scene : of_one_range.draw(number).noise) {
            for (const Cone& cone : scene.cones) EXPECT_LE(cone.position.norm(), 17.0);
        }
    }
    options.noise_share = 0.0;
    const FrontScenes without(courses(), options, 3);
    for (std::uint64_t number = 0; number < 50; ++number) EXPECT_TRUE(without.draw(number).noise.empty());
}

/// The judge learns that lanes in such scenes are wrong.
TEST(FrontJudgeLearner, TakesNoLaneOfNoiseForUsable) {
    const FrontScenes scenes(courses(), {}, 3);
    FrontWeights weights = random_front_weights(2);
    weights.usable = random_network(kWholeLaneFeatures, 7);
    weights.right = random_network(kRightInputs, 8);
    FrontJudgeLearner learner;
    const auto loss_of = [&](const FrontWeights& at, const Scene& scene, FrontWeights& derivatives) {
        FrontCost cost(at);
        FrontJudge judge(at);
        return learner.judge_noise(scene, at, cost, judge, {}, derivatives);
    };
    std::size_t found = 0;
    for (std::uint64_t number = 0; number < 200 && found < 3; ++number) {
        for (const Scene& scene : scenes.draw(number).noise) {
            FrontWeights derivatives = FrontWeights::zero();
            const double loss = loss_of(weights, scene, derivatives);
            if (loss == 0.0) continue;
            ++found;
            FrontWeights better = weights;
            better.usable.output_bias -= 1e-2F * derivatives.usable.output_bias;
            better.right.output_bias -= 1e-2F * derivatives.right.output_bias;
            EXPECT_GT(derivatives.usable.output_bias, 0.0F);
            EXPECT_GT(derivatives.right.output_bias, 0.0F);
            FrontWeights ignored = FrontWeights::zero();
            EXPECT_LT(loss_of(better, scene, ignored), loss);
        }
    }
    EXPECT_EQ(found, 3U);
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
    FrontTrainingOptions drawn = options;
    drawn.initial.reset();
    EXPECT_THROW((void)train_front(courses(), {}, drawn, {}), InvalidInput);
}

/// Lanes of random weights are rarely right, so the threshold depends on the drawn scenes.
TEST(FrontTraining, ChoosesTheThresholdOfTrustOnOtherCourses) {
    FrontTrainingOptions options = quick();
    options.initial = random_front_weights(4);
    options.initial->usable = random_network(kWholeLaneFeatures, 7);
    options.initial->right = random_network(kRightInputs, 8);
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

TEST(FrontScenes, DrawTheSameForTheSameNumber) {
    const FrontScenes scenes(courses(), {}, 1);
    std::size_t drawn_scenes = 0;
    for (std::uint64_t number = 0; number < 6; ++number) {
        const FrontScenes::Drawn first = scenes.draw(number);
        const FrontScenes::Drawn again = scenes.draw(number);
        ASSERT_EQ(first.scenes.size(), again.scenes.size());
        for (std::size_t i = 0; i < first.scenes.size(); ++i) {
            const AnnotatedScene& a = first.scenes[i];
            const AnnotatedScene& b = again.scenes[i];
            EXPECT_EQ(a.ground_truth, b.ground_truth);
            ASSERT_EQ(a.scene.cones.size(), b.scene.cones.size());
            for (std::size_t k = 0; k < a.scene.cones.size(); ++k)
                EXPECT_EQ(a.scene.cones[k].position, b.scene.cones[k].position);
            EXPECT_NO_THROW(validate(a.scene));
            ++drawn_scenes;
        }
    }
    EXPECT_GT(drawn_scenes, 12U);
}

// Whatever changes are made to a course, its ground truth is still a lane with the best score.
TEST(FrontScenes, TheirGroundTruthsAreUsable) {
    const FrontScenes scenes(courses(), {}, 2);
    std::size_t usable = 0;
    std::size_t all = 0;
    for (std::uint64_t number = 0; number < 40; ++number) {
        const FrontScenes::Drawn drawn = scenes.draw(number);
        for (const AnnotatedScene& scene : drawn.scenes) {
            LaneAnswer answer;
            answer.status = LaneStatus::found;
            answer.lane = *scene.ground_truth;
            const SceneScore scored = score(scene, answer, 0.0, std::nullopt, &drawn.boundaries);
            EXPECT_GT(scored.iou.value_or(0.0), 0.999);
            ++all;
            if (scored.usable().value_or(false)) ++usable;
        }
    }
    EXPECT_GT(all, 100U);
    EXPECT_EQ(usable, all);
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
    options.figures_every = 8;
    EXPECT_THROW((void)train_front(courses(), {}, options, [](const FrontProgress&) { throw Ended{}; }),
                 Ended);
    std::size_t first_report = 0;
    const FrontWeights resumed = train_front(courses(), {}, options, [&](const FrontProgress& progress) {
        if (first_report == 0) first_report = progress.step;
    });
    EXPECT_EQ(first_report, 8U) << "gone on from step 5";
    EXPECT_TRUE(resumed == whole);
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
    SceneOptions scenes;
    scenes.false_positive_rates = {0.2};
    scenes.ranges_m = {30.0};
    scenes.every_m = 12.0;
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
    SceneOptions scenes;
    scenes.false_positive_rates = {0.0};
    scenes.ranges_m = {30.0};
    scenes.every_m = 12.0;
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

TEST(FrontTraining, OptionsOutOfRangeAreNamed) {
    const auto key_of = [&](auto change) -> std::string {
        FrontTrainingOptions options = quick();
        change(options);
        try {
            validate(options);
        } catch (const InvalidInput& error) {
            return error.key();
        }
        return "accepted";
    };
    EXPECT_EQ(key_of([](auto&) {}), "accepted");
    EXPECT_EQ(key_of([](auto& o) { o.draws_per_step = 0; }), "draws_per_step");
    EXPECT_EQ(key_of([](auto& o) { o.scenes.scenes_per_draw = 0; }), "scenes_per_draw");
    EXPECT_EQ(key_of([](auto& o) { o.without = {"turn", "colour"}; }), "without");
    EXPECT_EQ(key_of([](auto& o) { o.judge_parts = {"usable", "left"}; }), "judge_parts");
    EXPECT_EQ(key_of([](auto& o) { o.scenes.noise_share = 1.1; }), "noise_share");
    EXPECT_EQ(key_of([](auto& o) { o.scenes.noise_cones = {9, 8}; }), "noise_cones");
    EXPECT_EQ(key_of([](auto& o) { o.scenes.noise_cones = {0, 8}; }), "noise_cones");
    EXPECT_EQ(key_of([](auto& o) { o.scenes.noise_ranges_m = {0.0, 8.0}; }), "noise_ranges_m");
    EXPECT_EQ(key_of([](auto& o) { o.scenes.noise_ranges_m = {9.0, 8.0}; }), "noise_ranges_m");
    EXPECT_EQ(key_of([](auto& o) { o.imitation_rate = -1.0; }), "imitation_rate");
    EXPECT_EQ(key_of([](auto& o) { o.search_rate = 0.0; }), "search_rate");
    EXPECT_EQ(key_of([](auto& o) { o.threads = 0; }), "threads");
    EXPECT_EQ(key_of([](auto& o) { o.loss.search.beam_width = 0; }), "beam_width");
    EXPECT_THROW((void)train_front({}, {}, quick(), {}), InvalidInput);
}

TEST(FrontTraining, ARunRecordsWhatItDependedOn) {
    FrontTrainingRunOptions options;
    options.tracks = {"generated:slalom@1"};
    options.hold_out = {"generated:kidney@2"};
    options.hold_out_every_m = 60.0;
    options.rates = {0.3};
    options.training = quick();
    std::size_t reports = 0;
    const FrontTrainingRun run = run_front_training(options, [&](const FrontProgress& progress) {
        ++reports;
        EXPECT_EQ(progress.held_out.size(), 2U);
    });
    EXPECT_EQ(reports, 3U);  // after 6, 12 and all 16 steps
    EXPECT_THAT(run.record, testing::HasSubstr(R"("tracks":["slalom@1"])"));
    EXPECT_THAT(run.record, testing::HasSubstr(R"("hold_out_tracks":["kidney@2"])"));
    EXPECT_THAT(run.record, testing::HasSubstr(R"("beam":6)"));
    options.trust_tracks = {"generated:kidney@3"};
    EXPECT_THAT(run_front_training(options, {}).record, testing::HasSubstr(R"("trust_tracks":["kidney@3"])"));
    options.trust_tracks = options.tracks;
    EXPECT_THROW((void)run_front_training(options, {}), InputError);
    options.trust_tracks.clear();
    options.hold_out = options.tracks;
    EXPECT_THROW((void)run_front_training(options, {}), InputError);
}

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
    const auto key_of = [](const nlohmann::ordered_json& json) -> std::string {
        try {
            (void)parse_front_weights(json.dump());
        } catch (const InvalidInput& error) {
            return error.key();
        }
        return "accepted";
    };
    for (const std::string key : {"colored_start_linear", "colored_least_trust"}) {
        auto json = nlohmann::ordered_json::parse(text);
        json.erase(key);
        EXPECT_EQ(key_of(json), key);
        json["version"] = 2;
        EXPECT_TRUE(key_of(json).starts_with("colored_")) << "of version 3";
    }
    weights.colored->stop.linear.pop_back();
    try {
        validate(weights);
        FAIL();
    } catch (const InvalidInput& error) {
        EXPECT_EQ(error.key(), "colored_stop.linear");
    }
}

TEST(FrontWeightsFile, TheLibraryHasTheWeightsOfItsFile) {
    std::ifstream file(source_directory() / "graph_search" / "weights" / "front.json");
    std::ostringstream text;
    text << file.rdbuf();
    EXPECT_TRUE(parse_front_weights(text.str()) == shipped_front_weights());
}

/// A file of version 1 has no features of colors; its numbers are those of the other features.
TEST(FrontWeightsFile, OfVersionOneKnowNoColors) {
    FrontWeights weights = random_front_weights(8);
    weights.rank = random_network(kWholeLaneFeatures, 5);
    weights.right = random_network(kRightInputs, 6);
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
    const auto key_of = [&](const std::string& from, const std::string& to) -> std::string {
        std::string text = good;
        const std::size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        text.replace(at, from.size(), to);
        try {
            (void)parse_front_weights(text);
        } catch (const InvalidInput& error) {
            return error.key();
        }
        return "accepted";
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
}  // namespace conelane::experiments
