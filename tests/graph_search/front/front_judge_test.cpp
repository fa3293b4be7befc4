// The judge of whole lanes in `front`: its inputs for competing lanes, and its outputs.

#include "graph_search/front/front_judge.hpp"

#include "graph_search/front/front_detector.hpp"
#include "tests/support/front_fixture.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/random_scenes.hpp"

#include <tuple>

namespace conelane {
namespace {

using tests::random_front_weights;
using tests::straight_front_scene;
using Cones = std::array<std::vector<Vertex>, 2>;

/// Indices of the features, by name.
template <std::size_t count>
std::size_t place_of(std::span<const FrontFeature, count> table, std::string_view name) {
    return static_cast<std::size_t>(std::ranges::find(table, name, &FrontFeature::name) - table.begin());
}
float lane_feature(const FrontJudge& judge, std::size_t contender, std::string_view name) {
    return judge.features(contender)[place_of(whole_lane_feature_table(), name)];
}
float cone_feature(const FrontJudge::Step& step, std::string_view name) {
    return step.inputs[place_of(cone_feature_table(), name)];
}

/// A search run to its end, and its best lanes judged.
class Judged {
  public:
    Judged(const Scene& scene, const FrontWeights& weights, FrontEvidence* evidence = nullptr)
        : cost_(weights), judge(weights) {
        search.begin(scene, cost_, {}, evidence);
        SearchBudget unlimited;
        search.run(unlimited);
        search.sort_finished(FrontJudge::kContenders);
        for (const FrontSearch::Finished& lane : search.finished()) {
            if (contenders.size() == FrontJudge::kContenders) break;
            contenders.push_back({lane.parent, lane.score});
            search.cones(lane.parent, lanes.emplace_back());
        }
        if (!contenders.empty()) judge.compare(search, contenders);
    }

  private:
    FrontCost cost_;

  public:
    FrontSearch search;
    std::vector<FrontJudge::Contender> contenders;
    std::vector<Cones> lanes;
    FrontJudge judge;
};

/// A segment by its side and cones; the first pair has a side of its own.
using Segments = std::set<std::array<Vertex, 3>>;
Segments segments_of(const Cones& lane) {
    Segments segments{{2, lane[kLeft].front(), lane[kRight].front()}};
    for (const Side side : {kLeft, kRight}) {
        for (std::size_t i = 1; i < lane[side].size(); ++i)
            segments.insert({static_cast<Vertex>(side), lane[side][i - 1], lane[side][i]});
    }
    return segments;
}

std::vector<double> softmax(const std::vector<FrontJudge::Contender>& contenders) {
    std::vector<double> result;
    double sum = 0.0;
    for (const auto& lane : contenders)
        sum += result.emplace_back(std::exp(lane.score - contenders.front().score));
    for (double& probability : result) probability /= sum;
    return result;
}

// Indices are looked up by name, as in files of weights.
TEST(FrontJudge, EveryFeatureHasANameOfItsOwn) {
    for (const FrontFeatureList& list : front_feature_lists()) {
        std::set<std::string_view> names;
        for (const FrontFeature& feature : list.features) {
            EXPECT_TRUE(names.insert(feature.name).second) << list.key << ": " << feature.name;
            EXPECT_FALSE(feature.unit.empty() || feature.reason.empty()) << list.key << ": " << feature.name;
        }
    }
}

TEST(FrontJudge, WithoutWeightsKeepsTheOrderOfTheSearch) {
    const Judged judged(tests::random_scene(3, 24), random_front_weights(1));
    ASSERT_GT(judged.contenders.size(), 2U);
    for (std::size_t i = 0; i < judged.judge.order().size(); ++i) EXPECT_EQ(judged.judge.order()[i], i);
    EXPECT_DOUBLE_EQ(judged.judge.confidence(0), 0.5);
}

/// Segments that lanes share, counted one by one.
TEST(FrontJudge, SharesAreThoseOfTheLanesWithTheSameSegment) {
    std::size_t met = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Judged judged(tests::random_scene(seed, 24), random_front_weights(seed));
        if (judged.contenders.empty()) continue;
        const std::vector<double> probability = softmax(judged.contenders);
        const std::vector<Segments> segments = mapped(judged.lanes, segments_of);
        for (std::size_t i = 0; i < judged.lanes.size(); ++i) {
            double least = 1.0;
            for (const auto& segment : segments[i]) {
                double share = 0.0;
                for (std::size_t j = 0; j < segments.size(); ++j)
                    share += segments[j].contains(segment) ? probability[j] : 0.0;
                least = std::min(least, share);
            }
            EXPECT_NEAR(lane_feature(judged.judge, i, "least_share"), least, 1e-5);
            EXPECT_NEAR(lane_feature(judged.judge, i, "probability"), probability[i], 1e-5);
            EXPECT_EQ(judged.judge.path(i).size(), segments[i].size());
            ++met;
        }
    }
    EXPECT_GT(met, 100U);
}

/// For a cone: the least share up to it, the best lane that has its segment, and how far that lane is ahead
/// of the best one without the segment.
TEST(FrontJudge, AConeIsSeenWithThoseBeforeItAndWithTheBestLaneThatHasIt) {
    std::size_t min_before = 0;
    std::size_t not_of_the_best = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Judged judged(tests::random_scene(seed, 24), random_front_weights(seed));
        if (judged.contenders.empty()) continue;
        const std::vector<double> probability = softmax(judged.contenders);
        const std::vector<Segments> segments = mapped(judged.lanes, segments_of);
        for (std::size_t i = 0; i < judged.lanes.size(); ++i) {
            float least = 1.0F;
            for (const std::uint32_t place : judged.judge.path(i)) {
                const FrontJudge::Step& step = judged.judge.steps()[place];
                const float share = cone_feature(step, "share");
                min_before += least < share ? 1 : 0;
                least = std::min(least, share);
                EXPECT_FLOAT_EQ(cone_feature(step, "least_share"), least);
                const auto best = std::ranges::find(probability, cone_feature(step, "probability"),
                                                    [](double p) { return static_cast<float>(p); });
                ASSERT_NE(best, probability.end());
                // Contenders stand in the order of their scores.
                const auto place_of_best = static_cast<std::size_t>(best - probability.begin());
                EXPECT_LE(place_of_best, i) << "this lane has it";
                not_of_the_best += place_of_best > 0 ? 1 : 0;
                Cones beginning;
                judged.search.cones(step.node, beginning);
                const Segments after = segments_of(beginning);
                const auto has_them = [&](const Segments& lane) {
                    return std::ranges::includes(lane, after);
                };
                for (std::size_t j = 0; j < place_of_best; ++j) EXPECT_FALSE(has_them(segments[j]));
            }
        }
    }
    EXPECT_GT(min_before, 20U);
    EXPECT_GT(not_of_the_best, 20U);
}

TEST(FrontJudge, AllAgreeOnALaneWithoutAnyOther) {
    const Judged judged(straight_front_scene(3), random_front_weights(4));
    ASSERT_FALSE(judged.contenders.empty());
    for (const FrontJudge::Step& step : judged.judge.steps()) {
        EXPECT_LE(cone_feature(step, "least_share"), cone_feature(step, "share"));
        EXPECT_LE(cone_feature(step, "share"), 1.0F + 1e-6F);
    }
    EXPECT_EQ(lane_feature(judged.judge, 0, "inside"), 0.0F);
    EXPECT_EQ(lane_feature(judged.judge, 0, "behind"), 0.0F);
}

/// The bonus of the last scene's lane in the search does not influence the judge.
TEST(FrontJudge, DoesNotSeeTheBonusOfTheLastLane) {
    const Scene scene = straight_front_scene(4);
    const FrontWeights weights = random_front_weights(4);
    const Judged without(scene, weights);
    const Cones& best = without.lanes.front();
    Lane last;
    for (const Vertex cone : best[kLeft])
        last.left.push_back(scene.cones[without.search.map().scene_index(cone)].id);
    for (const Vertex cone : best[kRight])
        last.right.push_back(scene.cones[without.search.map().scene_index(cone)].id);
    FrontEvidence evidence(0.5);
    evidence.remember(last);
    const Judged with(scene, weights, &evidence);
    ASSERT_EQ(with.lanes.front(), best);
    EXPECT_NEAR(with.contenders.front().score,
                without.contenders.front().score +
                    0.5 * static_cast<double>(best[kLeft].size() + best[kRight].size()),
                1e-5);
    const std::vector<std::uint32_t>& steps = with.judge.path(0);
    ASSERT_EQ(steps.size(), without.judge.path(0).size());
    for (std::size_t k = 0; k < steps.size(); ++k) {
        EXPECT_NEAR(cone_feature(with.judge.steps()[steps[k]], "move_score"),
                    cone_feature(without.judge.steps()[without.judge.path(0)[k]], "move_score"), 1e-5);
    }
}

TEST(FrontJudge, RankLiftsALaneOverBetterScores) {
    FrontWeights weights = random_front_weights(1);
    // A reward, larger than any difference of scores, for each cone that a lane does not have.
    weights.rank.linear[place_of(whole_lane_feature_table(), "cones")] = -1e4F;
    const Judged judged(tests::random_scene(3, 24), weights);
    ASSERT_GT(judged.contenders.size(), 2U);
    std::size_t before = 0;
    for (const std::size_t place : judged.judge.order()) {
        const std::size_t cones = judged.lanes[place][kLeft].size() + judged.lanes[place][kRight].size();
        EXPECT_GE(cones, before);
        before = cones;
    }
}

/// Each cone is right with probability 0.8 and the lane is usable, so three steps give 0.512 and four 0.41.
TEST(FrontJudge, TrustEndsBeforeTheConeThatCostsTooMuch) {
    FrontWeights weights = random_front_weights(6);
    weights.right.output_bias = static_cast<float>(std::log(0.8 / 0.2));
    weights.usable.output_bias = 50.0F;
    const auto trusted_m = [&](double least_trust) {
        weights.least_trust = least_trust;
        Judged judged(straight_front_scene(6), weights);
        const Cones& lane = judged.lanes.front();
        return judged.judge.trusted_m(judged.search, 0, {lane[kLeft].size(), lane[kRight].size()});
    };
    const Judged judged(straight_front_scene(6), weights);
    const auto segment_m = [&](Side side, std::size_t i) {
        const std::vector<Vertex>& boundary = judged.lanes.front()[side];
        const FrontMap& map = judged.search.map();
        return (map.position(boundary[i]) - map.position(boundary[i - 1])).norm();
    };
    EXPECT_EQ(trusted_m(0.9), 0.0);  // not even the first pair
    // The pair, the next left cone and the next right one: a segment on each side, and half a metre less.
    EXPECT_NEAR(trusted_m(0.5), std::min(segment_m(kLeft, 1), segment_m(kRight, 1)) - 0.5, 1e-5);
    EXPECT_EQ(trusted_m(0.6), 0.0);  // a segment on the left alone does not count
    EXPECT_LE(trusted_m(0.5), trusted_m(0.2));
    double whole_m = 0.0;
    for (const Side side : {kLeft, kRight}) {
        for (std::size_t i = 1; i < judged.lanes.front()[side].size(); ++i)
            whole_m += segment_m(side, i) / 2.0;
    }
    EXPECT_NEAR(trusted_m(0.0), whole_m, 1e-5);
}

/// Scenes without colors use the first set of weights only, the others the set for colors.
TEST(FrontJudge, ScenesWithColorsHaveWeightsOfTheirOwn) {
    FrontWeights first = random_front_weights(1);
    first.usable.output_bias = 1.0F;
    FrontWeights second = random_front_weights(2);
    second.usable.output_bias = 2.0F;
    second.least_trust = 0.0;
    FrontWeights both = first;
    both.colored = second;
    Scene scene = tests::random_scene(3, 24);
    const auto answer_of = [&](const FrontWeights& weights) {
        const LaneAnswer answer = make_front_detector({weights, {}})->detect(scene, tests::kNoTimeLimit);
        EXPECT_EQ(answer.status, LaneStatus::found);
        return std::tuple(answer.lane.left, answer.lane.right, answer.confidence, answer.trusted_m);
    };
    EXPECT_EQ(answer_of(both), answer_of(first));
    scene.cones.front().color = ConeColor::blue;
    EXPECT_EQ(answer_of(both), answer_of(second));
    EXPECT_NE(std::get<0>(answer_of(first)), std::get<0>(answer_of(second)));
    EXPECT_NE(std::get<3>(answer_of(first)), std::get<3>(answer_of(second)));
}

TEST(FrontJudge, DetectorSaysWhatItThinksOfItsBestLanes) {
    FrontWeights weights = random_front_weights(1);
    weights.usable = FrontNetworkWeights::zero(kWholeLaneFeatures);
    weights.usable.linear[place_of(whole_lane_feature_table(), "probability")] = 2.0F;
    const auto detector = make_front_detector({weights, {}});
    const Scene scene = tests::random_scene(3, 24);
    const LaneAnswer plain = detector->detect(scene, tests::kNoTimeLimit);
    ASSERT_EQ(plain.status, LaneStatus::found);
    EXPECT_TRUE(plain.enumeration.value().candidates.empty());
    DetectionLimits limits = tests::kNoTimeLimit;
    limits.keep_candidates = true;
    const LaneAnswer answer = detector->detect(scene, limits);
    EXPECT_EQ(answer.lane, plain.lane);
    EXPECT_EQ(answer.confidence, plain.confidence);
    const auto& candidates = answer.enumeration.value().candidates;
    ASSERT_GT(candidates.size(), 1U);
    EXPECT_LE(candidates.size(), FrontJudge::kContenders);
    EXPECT_EQ(candidates.front().lane, answer.lane);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        EXPECT_EQ(candidates[i].iteration, static_cast<std::int64_t>(i + 1));
        EXPECT_GT(*candidates[i].confidence, 0.5);
        for (std::size_t j = 0; j < i; ++j) EXPECT_NE(candidates[i].lane, candidates[j].lane);
    }
}

}  // namespace
}  // namespace conelane
