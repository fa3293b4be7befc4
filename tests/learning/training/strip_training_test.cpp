#include "learning/training/strip_training.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/formats/track_spec.hpp"
#include "tests/support/strip_scenes.hpp"

#include <iterator>

namespace conelane::learning {
namespace {

std::vector<Track> courses() {
    std::vector<Track> all = load_tracks("generated:kidney@4");
    std::ranges::move(load_tracks("generated:hairpins@2"), std::back_inserter(all));
    return all;
}

StripTrainingOptions quick() {
    StripTrainingOptions options;
    options.units = 3;
    options.steps = 6;
    options.draws_per_step = 2;
    options.scenes.scenes_per_draw = 2;
    options.report_every = 4;
    return options;
}

/// Derivatives of a lane's cost by each number, from differences of two costs.
TEST(StripTraining, TheGradientOfACostIsThatOfItsDifferences) {
    int compared = 0;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene = tests::random_scene(seed, 10);
        const StripParameters parameters = tests::random_strip_parameters(seed, 3);
        const StripProblem problem = make_strip_problem(scene, parameters);
        const StripReport best = StripSolver().solve(problem, {});
        if (best.lanes.empty()) continue;
        const StripLane& lane = best.lanes.front();
        const StripOfLane strip = cheapest_strip(problem, lane).value();
        const StripFeatures features(scene, problem.graph, problem.reach_m);
        StripCosts gradient = StripCosts::zero(3);
        add_strip_gradient(problem, features, lane, strip, 2.0, gradient);
        const Eigen::ArrayXd at = flat(*parameters.costs);
        const auto cost_at = [&](const Eigen::ArrayXd& values) {
            StripCosts costs = *parameters.costs;
            set(costs, values);
            return cheapest_strip(make_strip_problem(scene, StripLearner::with(parameters, costs)), lane)
                .value()
                .cost;
        };
        constexpr double kStep = 1e-6;
        for (Eigen::Index i = 0; i < at.size(); i += 5) {
            Eigen::ArrayXd step = Eigen::ArrayXd::Zero(at.size());
            step[i] = kStep;
            EXPECT_NEAR(flat(gradient)[i], (cost_at(at + step) - cost_at(at - step)) / kStep, 1e-4) << i;
            ++compared;
        }
    }
    EXPECT_GT(compared, 200);
}

/// Nearly all true lanes are strips, and a small step along the gradient lowers the loss of a scene.
TEST(StripTraining, LowersTheLossOfAScene) {
    StripTrainingOptions options = quick();
    options.max_cones = 1000;
    const FrontScenes scenes(courses(), options.scenes, 1);
    StripLearner learner(options);
    const StripCosts costs = hand_set_strip_costs();
    const StripParameters parameters = StripLearner::with(options.parameters, costs);
    int lowered = 0;
    int tried = 0;
    int drawn = 0;
    int allowed = 0;
    for (std::uint64_t number = 0; number < 25; ++number) {
        for (const AnnotatedScene& scene : scenes.draw(number).scenes) {
            StripCosts gradient = StripCosts::zero();
            const CostLoss loss = learner.add(scene, parameters, gradient);
            ++drawn;
            allowed += loss.allowed ? 1 : 0;
            if (!loss.allowed || loss.loss < 0.1) continue;
            ++tried;
            StripCosts next = costs;
            set(next, flat(costs) - 1e-4 * flat(gradient));
            StripCosts ignored = StripCosts::zero();
            if (learner.add(scene, StripLearner::with(parameters, next), ignored).loss < loss.loss) ++lowered;
        }
    }
    EXPECT_GT(allowed, drawn - drawn / 10);
    EXPECT_GE(tried, 10);
    EXPECT_GE(lowered, tried - 1);
}

TEST(StripTraining, GivesTheSameCostsOnAnyNumberOfThreadsAndOthersFromAnotherSeed) {
    StripTrainingOptions options = quick();
    std::vector<std::string> lines;
    const StripCosts costs =
        train_strip(courses(), options, [&](const std::string& line) { lines.push_back(line.substr(0, 9)); });
    EXPECT_THAT(lines, testing::ElementsAre("step 4 of", "step 6 of"));
    options.threads = 2;
    EXPECT_TRUE(train_strip(courses(), options, {}) == costs);
    options.seed = 1;
    EXPECT_FALSE(train_strip(courses(), options, {}) == costs);
    options.parameters.costs = std::make_shared<const StripCosts>(costs);
    options.units = 4;
    EXPECT_THROW((void)train_strip(courses(), options, {}), InvalidInput);
}

}  // namespace
}  // namespace conelane::learning
