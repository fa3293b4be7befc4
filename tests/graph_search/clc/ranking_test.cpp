
#include "graph_search/clc/clc_detector.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/straight_lane.hpp"

namespace conelane {
namespace {

/// One unit that passes on the given input, standardised; a negative weight reverses the preference.
RankNetWeights only_input(std::size_t input, float weight = 1.0F) {
    RankNetWeights weights;
    weights.mean = Eigen::VectorXd::Zero(8);
    weights.deviation = Eigen::VectorXd::Ones(8);
    weights.hidden = Eigen::MatrixXf::Zero(1, 8);
    weights.hidden(0, static_cast<Eigen::Index>(input)) = weight;
    weights.hidden_bias = Eigen::VectorXf::Constant(1, 1000.0F);  // far below the unit's limit
    weights.output = Eigen::VectorXf::Ones(1);
    return weights;
}

double named(const LaneFeatures& features, std::string_view name) {
    const auto names = lane_feature_names();
    return features[static_cast<std::size_t>(std::ranges::find(names, name) - names.begin())];
}

TEST(PaperFeatures, OfALaneToFollowByHand) {
    const std::vector<Point> left{{0, 4}, {3, 4}, {8, 4}};
    const std::vector<Point> right{{0, 0}, {4, 0}, {4, -3}};
    const PaperFeatures features = paper_features(left, right);
    EXPECT_DOUBLE_EQ(features[kLength], 7.5);
    EXPECT_EQ(features[kConesLeft], 3);
    EXPECT_EQ(features[kConesRight], 3);
    // Widths: left vertices 4, 4, sqrt(32); left segments 4, 4; right vertices 4, 4, 7; right segments 4, 4.
    const double mean = (8 * 4 + std::sqrt(32.0) + 7) / 10;
    EXPECT_NEAR(features[kWidthVariance], (8 * 16 + 32 + 49) / 10.0 - mean * mean, 1e-12);
    EXPECT_DOUBLE_EQ(features[kSegmentLengthVarianceLeft], 1.0);
    EXPECT_DOUBLE_EQ(features[kSegmentLengthVarianceRight], 0.25);
    EXPECT_DOUBLE_EQ(features[kTurnVarianceLeft], 0.0);
    EXPECT_DOUBLE_EQ(features[kTurnVarianceRight], 0.0) << "a single angle does not vary";
}

TEST(PaperFeatures, TurnsToEitherSideDiffer) {
    const std::vector<Point> zigzag{{0, 4}, {1, 5}, {2, 4}};
    const std::vector<Point> arc{{0, 0}, {1, 0}, {2, 1}, {2, 2}};
    const std::vector<Point> both_ways{{0, 0}, {1, 0}, {2, 1}, {3, 1}};
    EXPECT_NEAR(paper_features(zigzag, arc)[7], 0.0, 1e-12);
    EXPECT_NEAR(paper_features(zigzag, both_ways)[7], std::pow(std::atan(1.0), 2), 1e-12);
}

TEST(PaperFeatures, OfAClosedLaneIncludeTheClosing) {
    const std::vector<Point> inner{{2, 2}, {-2, 2}, {-2, -2}, {2, -2}};
    const std::vector<Point> outer{{5, 5}, {-5, 5}, {-5, -5}, {5, -5}};
    const PaperFeatures features = paper_features(inner, outer, true);
    EXPECT_DOUBLE_EQ(features[kLength], 28.0);
    EXPECT_NEAR(features[kSegmentLengthVarianceLeft], 0.0, 1e-12);
    EXPECT_NEAR(features[kTurnVarianceLeft], 0.0, 1e-12);
}

TEST(PaperFeatures, OfTheEnumerationEqualTheirDefinition) {
    std::size_t compared = 0;
    for (unsigned seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(seed);
        boost::random::mt19937_64 random(seed);
        boost::random::uniform_real_distribution<> ahead(1.0, 25.0);
        boost::random::uniform_real_distribution<> across(-4.0, 4.0);
        std::vector<Point> points{{0.5, 1.9}, {0.3, -1.8}};
        while (points.size() < 25) {
            const double x = ahead(random);
            points.emplace_back(x, across(random));
        }
        SearchGraph graph;
        graph.build(points, 5.5);
        EnumerationRules rules{.with_features = true};
        SearchBudget budget;
        PathPairs pairs;
        PathPairEnumeration enumeration;
        (void)enumeration.run(graph, {0, 1}, {1.0, 0.0}, rules, budget, pairs);
        ASSERT_EQ(pairs.features().size(), pairs.found().size());
        for (std::size_t i = 0; i < pairs.found().size(); ++i) {
            const PathPairVertices vertices = pairs.vertices(pairs.found()[i]);
            std::array<std::vector<Point>, 2> boundaries;
            for (const Side side : {kLeft, kRight}) {
                for (const Vertex vertex : vertices[side]) boundaries[side].push_back(points[vertex]);
            }
            const PaperFeatures expected =
                paper_features(boundaries[kLeft], boundaries[kRight], pairs.found()[i].closed);
            for (std::size_t k = 0; k < expected.size(); ++k)
                ASSERT_NEAR(pairs.features()[i][k], expected[k], 1e-9) << "feature " << k + 1;
            ++compared;
        }
    }
    EXPECT_GT(compared, 1000u);
}

TEST(NetworkInputs, DoNotTellLeftFromRight) {
    LaneFeatures lane{};
    for (std::size_t i = 0; i < lane.size(); ++i) lane[i] = static_cast<double>(i * i);
    LaneFeatures mirrored = lane;
    std::size_t pairs = 0;
    const std::span<const std::string_view> names = lane_feature_names();
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (!names[i].ends_with("_left")) continue;
        ASSERT_TRUE(names[i + 1].ends_with("_right"));
        std::swap(mirrored[i], mirrored[i + 1]);
        ++pairs;
    }
    EXPECT_EQ(pairs, 6u);
    std::vector<double> inputs(lane.size());
    std::vector<double> of_mirrored(lane.size());
    network_inputs(lane, inputs);
    network_inputs(mirrored, of_mirrored);
    EXPECT_EQ(inputs, of_mirrored);
    EXPECT_DOUBLE_EQ(inputs[1], (1.0 + 4.0) / 2.0);
    EXPECT_DOUBLE_EQ(inputs[2], (4.0 - 1.0) / 2.0);
}

TEST(LaneGrowth, OfALaneToFollowByHand) {
    // Two cones on a side, 4 m apart, a stray one inside the lane and one beside its left boundary.
    const std::vector<Point> points{{0, 2}, {0, -2}, {4, 2}, {4, -2}, {2, 1}, {3, 2.5}};
    SearchGraph graph;
    graph.build(points, 5.5);
    LaneGrowth growth;
    growth.start(graph, 0, 1, {1.0, 0.0});
    growth.push(graph, kLeft, 2);
    growth.push(graph, kRight, 3);
    const LaneFeatures features = growth.features();
    const auto of = [&](std::string_view name) { return named(features, name); };
    EXPECT_DOUBLE_EQ(of("length_m"), 4.0);
    EXPECT_DOUBLE_EQ(of("cones_inside"), 1.0);
    EXPECT_DOUBLE_EQ(of("cones_beside"), 2.0) << "the one inside is 1 m off the left boundary too";
    EXPECT_DOUBLE_EQ(of("longest_segment_m"), 4.0);
    EXPECT_DOUBLE_EQ(of("shortest_segment_m"), 4.0);
    EXPECT_DOUBLE_EQ(of("start_skew"), 0.0);
    EXPECT_DOUBLE_EQ(of("mean_squared_skew"), 0.0);
    EXPECT_DOUBLE_EQ(of("mean_across_m"), (4.0 + std::sqrt(32.0) + 4.0) / 3.0);
    EXPECT_DOUBLE_EQ(of("end_deviation"), 0.0);
    EXPECT_DOUBLE_EQ(of("end_segment_m"), 4.0);
}

// A left boundary along y = 2 with one vertex 1 m off beyond the near part, and a straight right one.
TEST(LaneGrowth, TellsTheNearPartFromTheRest) {
    std::vector<Point> points;
    for (int i = 0; i < 9; ++i) {
        points.emplace_back(4.0 * i, i == 7 ? 3.0 : 2.0);
        points.emplace_back(4.0 * i, -2.0);
    }
    SearchGraph graph;
    graph.build(points, 5.5);
    LaneGrowth growth;
    OnlineLaneWidth width;
    growth.start(graph, 0, 1, {1.0, 0.0});
    width.reset(points[0], points[1], 6.5);
    for (Vertex vertex = 2; vertex < points.size(); ++vertex) {
        growth.push(graph, vertex % 2, vertex);
        width.push(vertex % 2, points[vertex]);
    }
    LaneFeatures features = growth.features();
    add_width_features(width, growth.near_vertices(), features);
    const auto of = [&](std::string_view name) { return named(features, name); };
    // Steps begin at 0, 4, ..., 28 m; those from 0 to 20 m are near, six a side, and end at 24 m.
    EXPECT_EQ(of("near_vertices"), 14.0);
    EXPECT_EQ(of("near_sharpest_turn_rad"), 0.0);
    EXPECT_NEAR(of("sharpest_turn_rad"), 2.0 * std::atan(0.25), 1e-12);
    EXPECT_EQ(of("near_largest_offset_m"), 0.0);
    // The two vertices before and the two after 20 m (2, 2, 2, 3) suggest (4 (2 + 2) - (2 + 3)) / 6, 1/6 m
    // off; at 24 m (4 (2 + 3) - (2 + 2)) / 6 - 2 = 2/3 m, across a chord that rises 1 in 8.
    EXPECT_NEAR(of("largest_offset_m"), 2.0 / 3.0 * 8.0 / std::sqrt(65.0), 1e-12);
    EXPECT_EQ(of("near_narrowest_m"), 4.0);
    EXPECT_EQ(of("near_widest_m"), 4.0);
    EXPECT_NEAR(of("widest_m"), 5.0, 1e-12);
    EXPECT_EQ(of("near_width_deviation_m"), 0.0);
    EXPECT_EQ(of("near_longest_segment_m"), 4.0);
    EXPECT_EQ(of("near_largest_segment_change_m"), 0.0);
    EXPECT_EQ(of("near_curvature_difference_rad_per_m"), 0.0);
}

/// Rests that do not fill a batch of units or lanes.
TEST(RankNet, IsTheSameForAnyNumberOfUnitsAndLanes) {
    boost::random::mt19937_64 random(7);
    boost::random::uniform_real_distribution<float> draw(-1.0F, 1.0F);
    for (const Eigen::Index units : {1, 3, 4, 5, 64}) {
        for (const std::size_t count : {1U, 15U, 16U, 17U}) {
            RankNetWeights weights = only_input(0);
            weights.mean = Eigen::VectorXd::NullaryExpr(8, [&] { return draw(random); });
            weights.deviation = Eigen::VectorXd::NullaryExpr(8, [&] { return 1.5 + draw(random); });
            weights.hidden = Eigen::MatrixXf::NullaryExpr(units, 8, [&] { return draw(random); });
            weights.hidden_bias = Eigen::VectorXf::NullaryExpr(units, [&] { return draw(random); });
            weights.output = Eigen::VectorXf::NullaryExpr(units, [&] { return draw(random); });
            std::vector<LaneFeatures> lanes(count);
            for (LaneFeatures& lane : lanes) {
                for (double& feature : lane) feature = draw(random);
            }
            std::vector<double> scores(count);
            make_rank_net(weights)->score(lanes, scores);
            for (std::size_t i = 0; i < count; ++i) {
                Eigen::VectorXd inputs(8);
                network_inputs(lanes[i], {inputs.data(), 8});
                const Eigen::VectorXf standard =
                    ((inputs - weights.mean).array() / weights.deviation.array()).cast<float>();
                const Eigen::VectorXf hidden =
                    (weights.hidden * standard + weights.hidden_bias).cwiseMax(0.0F);
                EXPECT_NEAR(scores[i], weights.output.dot(hidden) + weights.output_bias, 1e-4)
                    << units << " units, lane " << i << " of " << count;
            }
        }
    }
}

TEST(RankNet, RejectsWeightsThatDoNotFitByName) {
    const auto key_of = [](auto change) {
        RankNetWeights weights = only_input(0);
        change(weights);
        return refused_key([&] { (void)make_rank_net(weights); });
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(key_of([](RankNetWeights&) {}), "accepted");
    EXPECT_EQ(key_of([](RankNetWeights& w) { w.mean.resize(9); }), "mean");
    EXPECT_EQ(key_of([](RankNetWeights& w) { w.deviation.resize(7); }), "deviation");
    EXPECT_EQ(key_of([](RankNetWeights& w) { w.hidden.resize(0, 8); }), "hidden");
    EXPECT_EQ(key_of([](RankNetWeights& w) { w.hidden.resize(1, 7); }), "hidden");
    EXPECT_EQ(key_of([&](RankNetWeights& w) { w.hidden(0, 3) = nan; }), "hidden");
    EXPECT_EQ(key_of([](RankNetWeights& w) { w.hidden_bias.resize(2); }), "hidden_bias");
    EXPECT_EQ(key_of([](RankNetWeights& w) { w.output.resize(0); }), "output");
    EXPECT_EQ(key_of([&](RankNetWeights& w) { w.output_bias = nan; }), "output_bias");
    EXPECT_EQ(key_of([&](RankNetWeights& w) { w.mean(7) = nan; }), "mean");
    EXPECT_EQ(key_of([](RankNetWeights& w) { w.deviation(0) = 0.0; }), "deviation");
}

TEST(RankNet, DecidesWhichCandidateTheDetectorAnswers) {
    const Scene scene = tests::straight_lane(5, 0.0);
    const auto cones_with = [&](std::size_t feature, float weight) {
        ClcOptions options;
        options.ranking = make_rank_net(only_input(feature, weight));
        const LaneAnswer answer = make_clc_detector(options)->detect(scene, tests::kNoTimeLimit);
        return std::pair(answer.lane.left.size(), answer.lane.right.size());
    };
    EXPECT_EQ(cones_with(0, -1.0F), (std::pair<std::size_t, std::size_t>(2, 2))) << "the shortest lane";
    const Lane longest = make_clc_detector({})->detect(scene, tests::kNoTimeLimit).lane;
    EXPECT_EQ(cones_with(0, 1.0F), std::pair(longest.left.size(), longest.right.size()));
}

}  // namespace
}  // namespace conelane
