
#include "evaluation/formats/track_spec.hpp"
#include "evaluation/scoring/score.hpp"
#include "graph_search/clc/clc_detector.hpp"
#include "learning/training/clc_training.hpp"
#include "tests/support/refusal.hpp"

#include <boost/random/uniform_01.hpp>

namespace conelane::learning {
namespace {

/// Scenes of ten candidates whose IoU falls with their fourth feature; the other features are random.
std::vector<CandidateList> lists_by_fourth_feature(std::size_t count, std::uint64_t seed) {
    boost::random::mt19937_64 random(seed);
    boost::random::uniform_01<double> uniform;
    std::vector<CandidateList> lists(count);
    for (CandidateList& list : lists) {
        for (int i = 0; i < 10; ++i) {
            LaneFeatures lane{};
            for (double& feature : lane) feature = 100.0 + 20.0 * uniform(random);
            list.iou.push_back(1.0 - (lane[3] - 100.0) / 20.0);
            list.divergence_m.push_back(std::numeric_limits<double>::infinity());
            list.usable.push_back(true);
            list.lanes.push_back(lane);
        }
    }
    return lists;
}

RankNetTrainingOptions quick() {
    return RankNetTrainingOptions{.units = 8, .epochs = 20, .pairs_a_step = 64, .show_progress = false};
}

TEST(Adam, ScalesEveryDerivativeByItsRootMeanSquare) {
    Adam adam(3, 1e-8);
    adam.add(Eigen::Array3d(4.0, -0.01, 0.0));
    // After one step, both means are unbiased: the quotient is the sign of the derivative.
    EXPECT_NEAR((adam.mean() / adam.deviation())(0), 1.0, 1e-6);
    EXPECT_NEAR((adam.mean() / adam.deviation())(1), -1.0, 1e-5);
    EXPECT_EQ((adam.mean() / adam.deviation())(2), 0.0);
    adam.add(Eigen::Array3d(-4.0, 0.01, 1.0));
    // 0.9 and 0.999 of the first with 0.1 and 0.001 of the second, over 1 - 0.9^2 and 1 - 0.999^2.
    EXPECT_NEAR((adam.mean() / adam.deviation())(0), (0.9 * 0.4 - 0.4) / 0.19 / 4.0, 1e-6);
    EXPECT_NEAR((adam.mean() / adam.deviation())(2), 0.1 / 0.19 / std::sqrt(0.001 / 0.001999), 1e-6);
    EXPECT_EQ(cosine_rate(0.5, 0.0), 0.5);
    EXPECT_NEAR(cosine_rate(0.5, 0.5), 0.25, 1e-12);
    EXPECT_NEAR(cosine_rate(0.5, 1.0), 0.0, 1e-12);
}

void fill_at_random(auto& values, boost::random::mt19937_64& random) {
    for (Eigen::Index i = 0; i < values.size(); ++i)
        values(i) = 2.0 * boost::random::uniform_01<double>()(random) - 1.0;
}

/// Of five units and eight inputs.
RankNetParameters random_parameters(boost::random::mt19937_64& random) {
    RankNetParameters parameters{Eigen::MatrixXd(5, 8), Eigen::VectorXd(5), Eigen::VectorXd(5)};
    fill_at_random(parameters.hidden, random);
    fill_at_random(parameters.hidden_bias, random);
    fill_at_random(parameters.output, random);
    return parameters;
}

/// The gradient is the slope of the loss along every parameter.
template <typename Loss, typename Batch>
void expect_slopes(const Loss& loss, const RankNetParameters& parameters, const Batch& batch) {
    RankNetParameters gradient;
    (void)loss(parameters, batch, &gradient);
    const Eigen::ArrayXd slopes = flat(gradient);
    const auto loss_at = [&](Eigen::Index i, double step) {
        Eigen::ArrayXd moved = flat(parameters);
        moved[i] += step;
        RankNetParameters other = parameters;
        set(other, moved);
        return loss(other, batch, nullptr);
    };
    constexpr double kStep = 1e-6;
    for (Eigen::Index i = 0; i < slopes.size(); ++i)
        EXPECT_NEAR(slopes[i], (loss_at(i, kStep) - loss_at(i, -kStep)) / (2.0 * kStep), 1e-8) << i;
}

TEST(PairLoss, OfOnePairByHand) {
    // One unit that passes on the only input: scores 3 and 1.
    const RankNetParameters parameters{Eigen::MatrixXd::Ones(1, 1), Eigen::VectorXd::Zero(1),
                                       Eigen::VectorXd::Ones(1)};
    CandidatePairs pairs{Eigen::MatrixXd::Constant(1, 1, 3.0), Eigen::MatrixXd::Ones(1, 1),
                         Eigen::RowVectorXd::Constant(1, 0.8)};
    const double p = 1.0 / (1.0 + std::exp(-2.0));
    EXPECT_NEAR(pair_loss(parameters, pairs, nullptr), -0.8 * std::log(p) - 0.2 * std::log(1.0 - p), 1e-12);
    pairs.first *= 1e6;
    EXPECT_TRUE(std::isfinite(pair_loss(parameters, pairs, nullptr)));
}

TEST(PairLoss, GradientEqualsFiniteDifferences) {
    boost::random::mt19937_64 random(4);
    const RankNetParameters parameters = random_parameters(random);
    CandidatePairs pairs{Eigen::MatrixXd(8, 7), Eigen::MatrixXd(8, 7), Eigen::RowVectorXd(7)};
    fill_at_random(pairs.first, random);
    fill_at_random(pairs.second, random);
    fill_at_random(pairs.first_is_better, random);
    pairs.first_is_better = pairs.first_is_better.cwiseAbs();
    expect_slopes(pair_loss, parameters, pairs);
}

TEST(ChoiceLoss, OfTwoScenesByHand) {
    // One unit that passes on the only input: scores 1 and 1 in the first scene, ln 3 and 0 in the second.
    const RankNetParameters parameters{Eigen::MatrixXd::Ones(1, 1), Eigen::VectorXd::Zero(1),
                                       Eigen::VectorXd::Ones(1)};
    CandidateScenes scenes{Eigen::MatrixXd(1, 4), Eigen::RowVectorXd(4), {0, 2, 4}};
    scenes.inputs << 1.0, 1.0, std::log(3.0), 0.0;
    scenes.quality << 0.9, 0.5, 1.0, -1.0;
    EXPECT_NEAR(choice_loss(parameters, scenes, nullptr), -(0.7 + (0.75 - 0.25)) / 2.0, 1e-12);
    scenes.inputs(0, 0) = 1e6;
    EXPECT_NEAR(choice_loss(parameters, scenes, nullptr), -(0.9 + 0.5) / 2.0, 1e-12);
}

TEST(ChoiceLoss, GradientEqualsFiniteDifferences) {
    boost::random::mt19937_64 random(9);
    const RankNetParameters parameters = random_parameters(random);
    CandidateScenes scenes{Eigen::MatrixXd(8, 7), Eigen::RowVectorXd(7), {0, 3, 7}};
    fill_at_random(scenes.inputs, random);
    fill_at_random(scenes.quality, random);
    expect_slopes(choice_loss, parameters, scenes);
}

TEST(RankNetTraining, LearnsWhatDecides) {
    RankNetTrainingOptions options = quick();
    const auto expect_learned = [&] {
        const RankNetWeights weights = train_rank_net(lists_by_fourth_feature(100, 1), options);
        const RankingFigures figures =
            ranking_figures(lists_by_fourth_feature(50, 2), *make_rank_net(weights));
        EXPECT_EQ(figures.scenes, 50u);
        EXPECT_GT(figures.mean_iou, figures.mean_best_iou - 0.02);
        EXPECT_EQ(figures.critical_share, 0.0);
    };
    expect_learned();
    options.loss = RankLoss::choice;
    options.scenes_a_step = 10;
    options.epochs = 60;
    expect_learned();
}

TEST(RankNetTraining, DecayKeepsTheWeightsSmall) {
    RankNetTrainingOptions options = quick();
    options.epochs = 60;
    const RankNetWeights without = train_rank_net(lists_by_fourth_feature(100, 1), options);
    options.weight_decay = 0.3;
    const RankNetWeights with = train_rank_net(lists_by_fourth_feature(100, 1), options);
    EXPECT_LT(with.hidden.norm(), 0.8F * without.hidden.norm());
    EXPECT_LT(with.output.norm(), 0.8F * without.output.norm());
    // The seven inputs without influence lose more of their weight than the one with influence.
    const auto share = [](const RankNetWeights& weights) {
        return weights.hidden.col(3).squaredNorm() / weights.hidden.squaredNorm();
    };
    EXPECT_GT(share(with), share(without));
    const RankingFigures figures = ranking_figures(lists_by_fourth_feature(50, 2), *make_rank_net(with));
    EXPECT_GT(figures.mean_iou, figures.mean_best_iou - 0.02);
}

TEST(RankNetTraining, StoresMeanAndDeviationOfTheInputs) {
    std::vector<CandidateList> lists = lists_by_fourth_feature(200, 3);
    for (CandidateList& list : lists) {
        for (LaneFeatures& lane : list.lanes) lane[0] = 7.0;  // constant
    }
    const RankNetWeights weights = train_rank_net(lists, quick());
    EXPECT_EQ(weights.mean.size(), 8);
    EXPECT_DOUBLE_EQ(weights.mean(0), 7.0);
    EXPECT_DOUBLE_EQ(weights.deviation(0), 1.0);
    EXPECT_NEAR(weights.mean(3), 110.0, 1.0);
    EXPECT_NEAR(weights.deviation(3), 20.0 / std::sqrt(12.0), 0.3);
    EXPECT_NEAR(weights.mean(2), 20.0 / 6.0, 0.3) << "half the distance of left and right";
}

/// The better half by the fourth feature diverges at 5 m, or ends too early.
TEST(RankNetTraining, APenaltyMakesLanesWorse) {
    const auto chosen = [](bool diverges, double RankNetTrainingOptions::*penalty) {
        std::vector<CandidateList> lists = lists_by_fourth_feature(200, 5);
        for (CandidateList& list : lists) {
            for (std::size_t i = 0; i < list.lanes.size(); ++i) {
                if (list.lanes[i][3] >= 110.0) continue;
                if (diverges) list.divergence_m[i] = 5.0;
                list.usable[i] = diverges;
            }
        }
        RankNetTrainingOptions options = quick();
        if (penalty != nullptr) options.*penalty = 1.0;
        return ranking_figures(lists, *make_rank_net(train_rank_net(lists, options)));
    };
    EXPECT_GT(chosen(true, nullptr).critical_share, 0.9);
    EXPECT_LT(chosen(true, &RankNetTrainingOptions::divergence_penalty).critical_share, 0.1);
    const RankingFigures early = chosen(false, &RankNetTrainingOptions::divergence_penalty);
    EXPECT_LT(early.usable_share, 0.1) << "none of them diverges";
    EXPECT_GT(early.most_usable_share, 0.9);
    EXPECT_EQ(early.critical_share, 0.0);
    EXPECT_GT(chosen(false, &RankNetTrainingOptions::unusable_penalty).usable_share, 0.9);
}

// One unit passes on the first feature, so the candidate with the largest one is chosen.
TEST(RankingFigures, OfThreeScenesByHand) {
    RankNetWeights weights{Eigen::VectorXd::Zero(8), Eigen::VectorXd::Ones(8), Eigen::MatrixXf::Zero(1, 8),
                           Eigen::VectorXf::Zero(1), Eigen::VectorXf::Ones(1)};
    weights.hidden(0, 0) = 1.0F;
    const auto list = [](std::vector<double> iou, std::vector<double> divergence_m,
                         std::vector<bool> usable) {
        CandidateList result;
        for (std::size_t i = 0; i < iou.size(); ++i) {
            result.lanes.emplace_back();
            result.lanes.back()[0] = static_cast<double>(i);
        }
        result.iou = std::move(iou);
        result.divergence_m = std::move(divergence_m);
        result.usable = std::move(usable);
        return result;
    };
    constexpr double kNever_m = std::numeric_limits<double>::infinity();
    // The choices are a usable lane, a lane that is too short beside a usable one, and nothing.
    const std::vector<CandidateList> lists{list({0.5, 0.99}, {5.0, kNever_m}, {false, true}),
                                           list({0.8, 0.2}, {kNever_m, kNever_m}, {true, false}),
                                           {}};
    const RankingFigures figures = ranking_figures(lists, *make_rank_net(weights));
    EXPECT_EQ(figures.scenes, 3u);
    EXPECT_DOUBLE_EQ(figures.usable_share, 1.0 / 3.0);
    EXPECT_DOUBLE_EQ(figures.most_usable_share, 2.0 / 3.0);
    EXPECT_DOUBLE_EQ(figures.mean_iou, (0.99 + 0.2) / 3.0);
    EXPECT_DOUBLE_EQ(figures.mean_best_iou, (0.99 + 0.8) / 3.0);
    EXPECT_DOUBLE_EQ(figures.near_best_share, 1.0 / 3.0);
    EXPECT_DOUBLE_EQ(figures.critical_share, 1.0 / 3.0);
    EXPECT_DOUBLE_EQ(figures.least_critical_share, 1.0 / 3.0);
}

TEST(RankNetTraining, RefusesOptionsThatDoNotFitEachOther) {
    RankNetTrainingOptions options = quick();
    options.weight_decay = 1.0 / options.learning_rate;
    EXPECT_EQ(refused_key([&] { (void)train_rank_net(lists_by_fourth_feature(2, 0), options); }), "--decay");
    options = quick();
    options.inputs = 9;
    EXPECT_EQ(refused_key([&] { (void)train_rank_net(lists_by_fourth_feature(2, 0), options); }), "inputs");
    EXPECT_THROW((void)train_rank_net({}, quick()), InvalidInput);
}

TEST(CandidateLists, AreBetterWhereABeamSearchLeads) {
    SceneOptions scenes{
        .false_positive_rates = {0.5}, .ranges_m = {50.0}, .every_m = 15.0, .conditions = {"car"}};
    const SceneSet set = make_scene_set({"generated:hairpins@99"}, scenes);
    CandidateListOptions options{.search = extended_search_options(), .show_progress = false};
    const std::vector<CandidateList> with = enumerate_candidates(set, options);
    options.search.step_scores = nullptr;
    const std::vector<CandidateList> without = enumerate_candidates(set, options);
    ASSERT_EQ(with.size(), without.size());
    ASSERT_FALSE(with.empty());
    double gained = 0.0;
    for (std::size_t i = 0; i < with.size(); ++i) {
        EXPECT_EQ(with[i].iou.size(), with[i].lanes.size());
        gained += with[i].best_iou() - without[i].best_iou();
    }
    EXPECT_GT(gained / static_cast<double>(with.size()), 0.003);
}

// A straight lane, cones 4 m apart, of which the car sees 32 m; a false one is 1.5 m off its left boundary.
TEST(CandidateLists, SayWhichLanesCanBeDrivenByAsTheScoringDoes) {
    SceneSet set;
    TrackBoundaries& boundaries = set.tracks["straight"];
    boundaries.closed = false;
    AnnotatedScene scene;
    scene.track = "straight";
    scene.ground_truth.emplace();
    for (int i = 0; i < 9; ++i) {
        const double x = 1.0 + 4.0 * i;
        scene.scene.cones.push_back({2 * i, {x, 2.0}});
        scene.scene.cones.push_back({2 * i + 1, {x + 0.2, -2.0}});
        scene.ground_truth->left.push_back(2 * i);
        scene.ground_truth->right.push_back(2 * i + 1);
        boundaries.left.push_back(scene.scene.cones[static_cast<std::size_t>(2 * i)].position);
        boundaries.right.push_back(scene.scene.cones[static_cast<std::size_t>(2 * i + 1)].position);
    }
    scene.scene.cones.push_back({100, {9.0, 3.5}});  // beside the third left cone
    set.scenes.push_back(scene);
    CandidateListOptions options{.show_progress = false};
    const std::vector<CandidateList> lists = enumerate_candidates(set, options);
    ASSERT_EQ(lists.size(), 1u);

    CandidateSearch search(options.search);
    const CandidateSearch::Request request;
    (void)search.run(scene.scene, request);
    const std::vector<PathPair>& pairs = search.pairs().found();
    ASSERT_EQ(lists.front().usable.size(), pairs.size());
    const auto usable = [&](const std::vector<ConeId>& left, const std::vector<ConeId>& right) {
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            if (search.lane(pairs[i], scene.scene) == Lane{left, right})
                return std::optional<bool>(lists.front().usable[i]);
        }
        ADD_FAILURE() << "no such candidate";
        return std::optional<bool>();
    };
    EXPECT_EQ(usable({0, 2, 4, 6, 8, 10, 12, 14, 16}, {1, 3, 5, 7, 9, 11, 13, 15, 17}), true);
    EXPECT_EQ(usable({0, 2, 4, 6, 8, 10}, {1, 3, 5, 7, 9, 11}), true) << "20 m are enough";
    EXPECT_EQ(usable({0, 2, 4, 6, 8}, {1, 3, 5, 7, 9, 11}), false) << "18 m are not";
    EXPECT_EQ(usable({0, 2}, {1, 3}), false) << "a stub leaves no track";
    EXPECT_EQ(usable({0, 2, 100, 6, 8, 10, 12, 14, 16}, {1, 3, 5, 7, 9, 11, 13, 15, 17}), false)
        << "past the false positive";
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        LaneAnswer answer{.status = LaneStatus::found, .lane = search.lane(pairs[i], scene.scene)};
        const SceneScore scored = score(scene, answer, 0.0, std::nullopt, &boundaries);
        EXPECT_EQ(lists.front().usable[i], scored.usable()) << "candidate " << i;
    }
}

TEST(TrainingRun, GivesTheSameBytesFromTheSameSeedOnAnyNumberOfThreads) {
    TrainingRunOptions options;
    options.tracks = {"generated:circle@1"};
    options.hold_out = {"generated:curvy@2"};
    options.scenes.false_positive_rates = {0.0, 0.2};
    options.scenes.ranges_m = {20.0};
    options.scenes.every_m = 20.0;
    options.candidates.max_per_scene = 10;
    options.candidates.show_progress = false;
    options.training = quick();
    const auto scenes_of = [](const std::string& file, const char* figures) {
        return nlohmann::json::parse(file).at("training").at(figures).at("scenes").get<std::size_t>();
    };
    const std::string alone = run_training(options).file;
    EXPECT_GT(scenes_of(alone, "figures_of_hold_out"), 0U);
    // Variants of the tracks are learned from too, and the record names the tracks alone.
    options.variants = 2;
    const std::string varied = run_training(options).file;
    EXPECT_GE(scenes_of(varied, "figures_of_training"), 2 * scenes_of(alone, "figures_of_training"));
    EXPECT_THAT(varied, testing::HasSubstr("\"tracks\": [\"circle@1\"],\n  \"variants\": 2"));
    options.candidates.threads = options.scenes.threads = 2;
    EXPECT_EQ(run_training(options).file, varied);
    options.training.seed = 1;
    EXPECT_NE(run_training(options).file, varied);
}

TEST(TrackVariant, IsStretchedAndEverySecondOneIsDrivenTheOtherWay) {
    const Track track = load_tracks("generated:hairpins@3").front();
    for (std::size_t number = 1; number <= 4; ++number) {
        SCOPED_TRACE(number);
        const Track variant = track_variant(track, number, 7);
        EXPECT_EQ(variant.name, track.name + "_variant" + std::to_string(number));
        EXPECT_EQ(variant.closed, track.closed);
        if (number % 2 == 1) {
            EXPECT_EQ(variant.left, track.left);
            EXPECT_EQ(variant.right, track.right);
        } else {
            EXPECT_TRUE(
                std::ranges::equal(variant.left, std::vector(track.right.rbegin(), track.right.rend())));
            EXPECT_TRUE(
                std::ranges::equal(variant.right, std::vector(track.left.rbegin(), track.left.rend())));
        }
        ASSERT_EQ(variant.cones.size(), track.cones.size());
        double shortest = 1.0;
        double longest = 1.0;
        for (std::size_t i = 1; i < track.cones.size(); ++i) {
            EXPECT_EQ(variant.cones[i].id, track.cones[i].id);
            const double stretch = (variant.cones[i].position - variant.cones[i - 1].position).norm() /
                                   (track.cones[i].position - track.cones[i - 1].position).norm();
            shortest = std::min(shortest, stretch);
            longest = std::max(longest, stretch);
        }
        EXPECT_GE(shortest, std::exp(-0.15) - 1e-9);
        EXPECT_LE(longest, std::exp(0.15) + 1e-9);
        EXPECT_GT(longest - shortest, 1e-3);
        EXPECT_EQ(track_variant(track, number, 7).cones[5].position, variant.cones[5].position);
        EXPECT_NE(track_variant(track, number, 8).cones[5].position, variant.cones[5].position);
        EXPECT_NE(track_variant(track, number + 1, 7).cones[5].position, variant.cones[5].position);
    }
}

}  // namespace
}  // namespace conelane::learning
