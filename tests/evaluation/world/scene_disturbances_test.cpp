// Disturbances of a scene: false positives, noise, wrong colors, confidences.

#include "tests/support/toy_track_scenes.hpp"

namespace conelane {
namespace {

TEST(SceneGeneration, RatesGiveTheNumberOfFalsePositives) {
    // Seven points are seen: k / (7 + k) = rate.
    const std::vector<std::pair<double, std::size_t>> expected{{0.0, 0}, {0.1, 1}, {1.0 / 6.0, 1},
                                                               {0.3, 3}, {0.5, 7}, {0.99, 693}};
    for (const auto& [rate, count] : expected) {
        const auto scenes = generate(straight(), {{{7.0, 0.0}, 0.0}}, options({rate}, {15.0}));
        ASSERT_THAT(scenes, SizeIs(1));
        EXPECT_THAT(scenes[0].scene.cones, SizeIs(7 + count)) << rate;
        EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->left), ElementsAre(10, 15, 20)) << rate;
    }
}

TEST(SceneGeneration, FalsePositivesFillTheHalfDiscAndOnlyIt) {
    int scenes_made = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(seed);
        SceneOptions wanted = options({0.99}, {15.0});
        wanted.seed = seed;
        const double yaw_rad = 0.3 * static_cast<double>(seed) - 3.0;
        const Track track = circle();
        const auto scenes = generate(track, {{{0.5, 0.25}, yaw_rad}}, wanted);
        if (scenes.empty()) continue;  // fewer than two cones of a side are ahead
        ++scenes_made;
        const Scene& scene = scenes[0].scene;
        double ahead_m = 0.0;
        double left_m = 0.0;
        std::size_t count = 0;
        for (const Cone& cone : scene.cones) {
            const bool of_track = std::ranges::any_of(
                track.cones, [&](const Cone& other) { return other.position == cone.position; });
            EXPECT_GE(scene.pose.ahead_m(cone.position), 0.0);
            EXPECT_LE((cone.position - scene.pose.position).norm(), 15.0 + 1e-12);
            if (of_track) continue;
            ++count;
            ahead_m += scene.pose.ahead_m(cone.position);
            left_m += scene.pose.left_m(cone.position);
        }
        // Centroid of a half disc: 4 r / (3 pi) ahead, on the axis. About 1200 points: 5 standard errors.
        ASSERT_GT(count, 900u);
        EXPECT_NEAR(ahead_m / static_cast<double>(count), 4.0 * 15.0 / (3.0 * std::numbers::pi), 0.7);
        EXPECT_NEAR(left_m / static_cast<double>(count), 0.0, 1.2);
    }
    EXPECT_GE(scenes_made, 10);
}

TEST(SceneGeneration, DisturbancesHaveTheRequestedSpread) {
    const std::vector<Pose> poses(1000, Pose{{7.0, 0.0}, 0.0});
    SceneOptions wanted = options({0.0}, {15.0});
    wanted.pose_noise_lateral_m = 0.3;
    wanted.pose_noise_yaw_rad = 0.05;
    double squared_lateral = 0.0;
    double squared_yaw = 0.0;
    const auto displaced = generate(straight(), poses, wanted);
    ASSERT_THAT(displaced, SizeIs(1000));
    for (const auto& scene : displaced) {
        EXPECT_EQ(scene.scene.pose.position.x(), 7.0);
        squared_lateral += std::pow(scene.scene.pose.position.y(), 2);
        squared_yaw += std::pow(scene.scene.pose.yaw_rad, 2);
    }
    EXPECT_NEAR(std::sqrt(squared_lateral / 1000), 0.3, 0.03);
    EXPECT_NEAR(std::sqrt(squared_yaw / 1000), 0.05, 0.005);

    wanted = options({0.0}, {15.0});
    wanted.noise_sigma_m = 0.1;
    double squared = 0.0;
    for (const auto& scene : generate(straight(), poses, wanted)) {
        EXPECT_THAT(scene.scene.cones, SizeIs(7)) << "which cones are visible does not depend on the noise";
        squared += (cone_of(scene, scene.ground_truth->left[0]).position - Point(10.0, 1.5)).squaredNorm();
    }
    EXPECT_NEAR(std::sqrt(squared / 2000), 0.1, 0.01);

    wanted = options({0.0}, {40.0});
    wanted.noise_sigma_m = 0.1;
    wanted.noise_by_range = 0.02;
    for (const std::size_t place : {0U, 6U}) {  // 3.4 m and 33 m from the car
        const double distance_m = Point(3.0 + 5.0 * static_cast<double>(place), 1.5).norm();
        squared = 0.0;
        for (const auto& scene : generate(straight(), poses, wanted)) {
            const Point truth(10.0 + 5.0 * static_cast<double>(place), 1.5);
            squared += (cone_of(scene, scene.ground_truth->left.at(place)).position - truth).squaredNorm();
        }
        const double expected_m = std::hypot(0.1, 0.02 * distance_m);
        EXPECT_NEAR(std::sqrt(squared / 2000), expected_m, 0.1 * expected_m);
    }

    wanted = options({0.0}, {40.0});
    wanted.miss_rate = 0.2;
    std::size_t seen = 0;
    for (const auto& scene : generate(straight(), poses, wanted)) seen += scene.scene.cones.size();
    // From x = 7 to x = 47: eight cones a side and the stray point.
    EXPECT_NEAR(static_cast<double>(seen) / 17000.0, 0.8, 0.01);
}

/// As a sensor states it, by where the cone is seen: it does not tell false positives from true ones.
TEST(SceneGeneration, NoiseByRangeComesWithTheCovarianceOfEveryCone) {
    const std::vector<Pose> poses(3, Pose{{7.0, 0.0}, 0.0});
    SceneOptions wanted = options({0.3}, {30.0});
    wanted.noise_sigma_m = 0.1;
    const auto without = generate(straight(), poses, wanted);
    for (const Cone& cone : without[0].scene.cones) EXPECT_FALSE(cone.position_covariance.has_value());
    wanted.noise_by_range = 0.0;
    EXPECT_EQ(bytes(generate(straight(), poses, wanted)), bytes(without));
    wanted.noise_by_range = 0.02;
    for (const auto& scene : generate(straight(), poses, wanted)) {
        EXPECT_THAT(scene.scene.id, testing::EndsWith("/noise_0.1/noise_by_range_0.02"));
        EXPECT_NO_THROW(validate(scene.scene));
        for (const Cone& cone : scene.scene.cones) {
            const double distance_m = (cone.position - scene.scene.pose.position).norm();
            const double variance_m2 = 0.01 + std::pow(0.02 * distance_m, 2);
            ASSERT_TRUE(cone.position_covariance.has_value());
            EXPECT_NEAR(cone.position_covariance->xx_m2, variance_m2, 1e-6);
            EXPECT_EQ(cone.position_covariance->yy_m2, cone.position_covariance->xx_m2);
            EXPECT_EQ(cone.position_covariance->xy_m2, 0.0);
        }
    }
}

TEST(SceneGeneration, ColorsShowOnlyWhereAskedForAndFalsePositivesHaveAnyOfThem) {
    Track track = straight();
    track.cones[track.left[2]].color = ConeColor::orange;
    track.cones[track.left[3]].color = ConeColor::yellow;  // a wrong color in the recording
    SceneOptions wanted = options({0.9}, {15.0});
    const auto colorless = generate(track, {{{7.0, 0.0}, 0.0}}, wanted);
    for (const Cone& cone : colorless[0].scene.cones) EXPECT_EQ(cone.color, ConeColor::unknown);
    wanted.with_color = true;
    const auto scenes = generate(track, {{{7.0, 0.0}, 0.0}}, wanted);
    const Lane& lane = *scenes[0].ground_truth;
    EXPECT_EQ(cone_of(scenes[0], lane.left[0]).color, ConeColor::orange);
    EXPECT_EQ(cone_of(scenes[0], lane.left[1]).color, ConeColor::blue);
    EXPECT_EQ(cone_of(scenes[0], lane.right[0]).color, ConeColor::yellow);
    std::map<ConeColor, int> count;
    for (const Cone& cone : scenes[0].scene.cones) ++count[cone.color];
    EXPECT_EQ(count[ConeColor::orange], 1);
    for (const ConeColor color : {ConeColor::blue, ConeColor::yellow, ConeColor::unknown}) {
        EXPECT_GT(count[color], 10);  // of 63 false positives
    }
}

TEST(SceneGeneration, UnknownColorsAreThoseOfTheCourseAlone) {
    const std::vector<Pose> poses(1000, Pose{{7.0, 0.0}, 0.0});
    SceneOptions wanted = options({0.3}, {15.0});
    wanted.with_color = true;
    wanted.color_error_rate = 0.1;
    const auto seen = generate(straight(), poses, wanted);
    wanted.color_unknown_rate = 0.4;
    const auto scenes = generate(straight(), poses, wanted);
    ASSERT_THAT(scenes, SizeIs(1000));
    EXPECT_EQ(scenes[3].scene.id, "toy/pose_0003/fp_0.30/range_15/color_error_0.1/color_unknown_0.4");
    double unknown = 0.0;
    double boundary = 0.0;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        std::set<ConeId> on_lane(scenes[i].ground_truth->left.begin(), scenes[i].ground_truth->left.end());
        on_lane.insert(scenes[i].ground_truth->right.begin(), scenes[i].ground_truth->right.end());
        for (const Cone& cone : scenes[i].scene.cones) {
            const ConeColor before = cone_of(seen[i], cone.id).color;
            if (cone.color != ConeColor::unknown || !on_lane.contains(cone.id)) {
                // Seen points and false positives are the same as without colors; the stray point of the map
                // is unknown.
                EXPECT_EQ(cone.color, before);
            }
            if (!on_lane.contains(cone.id)) continue;
            boundary += 1.0;
            unknown += cone.color == ConeColor::unknown ? 1.0 : 0.0;
        }
    }
    EXPECT_NEAR(unknown / boundary, 0.4, 0.03);
}

TEST(SceneGeneration, ColorErrorsPaintConesOfABoundaryLikeTheOtherOne) {
    const std::vector<Pose> poses(1000, Pose{{7.0, 0.0}, 0.0});
    SceneOptions wanted = options({0.3}, {15.0});
    wanted.with_color = true;
    const auto right = generate(straight(), poses, wanted);
    wanted.color_error_rate = 0.2;
    const auto scenes = generate(straight(), poses, wanted);
    ASSERT_THAT(scenes, SizeIs(1000));
    EXPECT_EQ(scenes[3].scene.id, "toy/pose_0003/fp_0.30/range_15/color_error_0.2");
    int wrong = 0;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const auto count = [&](const std::vector<ConeId>& run, ConeColor own, ConeColor other) {
            for (const ConeId id : run) {
                const ConeColor color = cone_of(scenes[i], id).color;
                EXPECT_TRUE(color == own || color == other);
                if (color == other) ++wrong;
            }
        };
        count(scenes[i].ground_truth->left, ConeColor::blue, ConeColor::yellow);
        count(scenes[i].ground_truth->right, ConeColor::yellow, ConeColor::blue);
        // Everything else is unchanged: the same false positives in the same order.
        ASSERT_EQ(scenes[i].scene.cones.size(), right[i].scene.cones.size());
        for (std::size_t c = 0; c < right[i].scene.cones.size(); ++c)
            EXPECT_EQ(scenes[i].scene.cones[c].position, right[i].scene.cones[c].position);
    }
    EXPECT_NEAR(wrong / 6000.0, 0.2, 0.02);  // three cones a side in each scene
}

/// Means and spreads of the two distributions by the formulas of Beta distributions, and the share of pairs
/// in which the real cone has the higher confidence.
TEST(SceneGeneration, ConfidencesOfConesAndFalsePositivesOverlap) {
    const std::vector<Pose> poses(1000, Pose{{7.0, 0.0}, 0.0});
    SceneOptions wanted = options({0.5}, {15.0});
    const auto plain = generate(straight(), poses, wanted);
    wanted.with_confidence = true;
    const auto scenes = generate(straight(), poses, wanted);
    std::vector<double> real;
    std::vector<double> others;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const Lane& lane = *scenes[i].ground_truth;
        for (std::size_t c = 0; c < scenes[i].scene.cones.size(); ++c) {
            const Cone& cone = scenes[i].scene.cones[c];
            EXPECT_EQ(plain[i].scene.cones[c].confidence, 1.0);
            EXPECT_EQ(plain[i].scene.cones[c].position, cone.position);
            ASSERT_TRUE(cone.confidence >= 0.0 && cone.confidence <= 1.0);
            const bool on_lane =
                std::ranges::count(lane.left, cone.id) + std::ranges::count(lane.right, cone.id) > 0;
            (on_lane ? real : others).push_back(cone.confidence);
        }
    }
    const auto expect_beta = [](const std::vector<double>& values, double a, double b) {
        const auto count = static_cast<double>(values.size());
        double sum = 0.0;
        double squares = 0.0;
        for (const double value : values) {
            sum += value;
            squares += value * value;
        }
        const double mean = sum / count;
        EXPECT_NEAR(mean, a / (a + b), 0.01);
        EXPECT_NEAR(squares / count - mean * mean, a * b / ((a + b) * (a + b) * (a + b + 1.0)), 0.002);
    };
    ASSERT_THAT(real, SizeIs(6000));
    ASSERT_THAT(others, SizeIs(8000));  // the stray point of the map and seven false positives
    expect_beta(real, 5.0, 2.0);
    expect_beta(others, 2.0, 4.0);
    int higher = 0;
    for (std::size_t i = 0; i < real.size(); ++i) {
        if (real[i] > others[i]) ++higher;
    }
    EXPECT_NEAR(higher / 6000.0, 0.93, 0.01);
}

}  // namespace
}  // namespace conelane
