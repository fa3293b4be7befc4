// The derivatives by which the cost and the judge of `front` learn.

#include "evaluation/world/generated_tracks.hpp"
#include "learning/training/front_learner.hpp"
#include "learning/training/front_scenes.hpp"
#include "tests/support/front_fixture.hpp"

namespace conelane::learning {
namespace {

using tests::random_front_network;
using tests::random_front_weights;

std::vector<Track> courses() {
    return {generate_track("hairpins", 1), generate_track("kidney", 2)};
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

FrontWeights small_weights() {
    FrontWeights weights = random_front_weights(2);
    for_each_block(weights, [](std::span<float> block) {
        for (float& number : block) number *= 0.3F;
    });
    return weights;
}

/// The loss of a scene falls along its gradient by the amount that the gradient predicts.
TEST(FrontLearner, ItsDerivativesAreThoseOfTheLoss) {
    const FrontScenes::Drawn drawn = FrontScenes(courses(), {}, 3).draw(5);
    ASSERT_FALSE(drawn.scenes.empty());
    FrontWeights weights = small_weights();
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
    const FrontScenes::Drawn drawn = FrontScenes(courses(), {}, 3).draw(5);
    ASSERT_FALSE(drawn.scenes.empty());
    FrontWeights weights = small_weights();
    weights.rank = weights.usable = random_front_network(kWholeLaneFeatures, 7);
    weights.right = random_front_network(kRightInputs, 8);
    FrontLossOptions options;
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

/// The judge learns that lanes in such scenes are wrong.
TEST(FrontJudgeLearner, TakesNoLaneOfNoiseForUsable) {
    const FrontScenes scenes(courses(), {}, 3);
    FrontWeights weights = random_front_weights(2);
    weights.usable = random_front_network(kWholeLaneFeatures, 7);
    weights.right = random_front_network(kRightInputs, 8);
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

}  // namespace
}  // namespace conelane::learning
