#include "tests/support/toy_track_scenes.hpp"

namespace conelane {
namespace {

TEST(SceneConditions, LapsFollowOneAnotherAndNameTheirCondition) {
    SceneOptions wanted = options({0.0, 0.3}, {15.0, 20.0});
    wanted.conditions = {"car", "paper"};
    std::vector<std::string> ids;
    std::vector<std::string> conditions;
    for (const auto& scene : generate(straight(), {{{7.0, 0.0}, 0.0}}, wanted)) {
        ids.push_back(scene.scene.id);
        conditions.push_back(scene.condition);
    }
    EXPECT_THAT(ids, ElementsAre("toy/pose_0000/fp_0.00/range_15/car", "toy/pose_0000/fp_0.30/range_15/car",
                                 "toy/pose_0000/fp_0.00/range_20/car", "toy/pose_0000/fp_0.30/range_20/car",
                                 "toy/pose_0000/fp_0.00/range_15", "toy/pose_0000/fp_0.30/range_15",
                                 "toy/pose_0000/fp_0.00/range_20", "toy/pose_0000/fp_0.30/range_20"));
    EXPECT_THAT(conditions, ElementsAre("car", "car", "car", "car", "paper", "paper", "paper", "paper"));
}

TEST(SceneConditions, PaperIsNotDisturbed) {
    const std::vector<Pose> poses{{{7.0, 0.0}, 0.0}, {{9.0, 0.0}, 0.1}};
    auto named = generate(straight(), poses, in_conditions({"paper"}, 0.3));
    for (AnnotatedScene& scene : named) {
        EXPECT_EQ(scene.condition, "paper");
        scene.condition.clear();
    }
    EXPECT_EQ(bytes(named), bytes(generate(straight(), poses, options({0.3}, {15.0}))));
}

TEST(SceneConditions, AnOptionReplacesItsPartAndTheNameSaysSo) {
    const auto names = [](const std::function<void(SceneOptions&)>& change) {
        SceneOptions wanted = in_conditions({"paper", "car"});
        change(wanted);
        return condition_names(wanted);
    };
    EXPECT_THAT(names([](SceneOptions&) {}), ElementsAre("paper", "car"));
    EXPECT_THAT(names([](SceneOptions& o) { o.noise_sigma_m = 0.1; }), ElementsAre("paper+noise_0.1", "car"));
    EXPECT_THAT(names([](SceneOptions& o) { o.noise_by_range = 0.02; }),
                ElementsAre("paper+noise_by_range_0.02", "car+noise_by_range_0.02"));
    EXPECT_THAT(names([](SceneOptions& o) { o.miss_rate = 0.0; }), ElementsAre("paper", "car+miss_0"));
    EXPECT_THAT(names([](SceneOptions& o) { o.persistent = false; }), ElementsAre("paper", "car+no_persist"));
    EXPECT_THAT(names([](SceneOptions& o) { o.persistent = true; }), ElementsAre("paper+persist", "car"));
    EXPECT_THAT(names([](SceneOptions& o) {
                    o.pose_noise_lateral_m = 0.5;
                    o.pose_noise_yaw_rad = 0.0;
                    o.miss_rate = 0.2;
                }),
                ElementsAre("paper+pose_noise_0.5_0+miss_0.2", "car+pose_noise_0.5_0+miss_0.2"));
    EXPECT_THAT(condition_names(options({0.0}, {15.0})), IsEmpty());

    SceneOptions wanted = in_conditions({"car"});
    wanted.miss_rate = 0.0;
    const auto scenes = generate(straight(), {{{7.0, 0.0}, 0.0}}, wanted);
    ASSERT_THAT(scenes, SizeIs(1));
    EXPECT_EQ(scenes[0].scene.id, "toy/pose_0000/fp_0.00/range_15/car+miss_0");
    EXPECT_THAT(scenes[0].missed, IsEmpty());
}

/// The standard deviations and the share of missed cones are those in measures.md.
TEST(SceneConditions, CarAndHarshHaveTheirDocumentedDisturbances) {
    struct Expected {
        const char* name;
        double noise_m;
        double lateral_m;
        double yaw_degrees;
        double missed;
    };
    const std::vector<Pose> poses(4000, Pose{{7.0, 0.0}, 0.0});
    const Track track = straight();
    for (const Expected& expected :
         {Expected{"car", 0.1, 0.3, 5.0, 0.05}, Expected{"harsh", 0.2, 0.5, 8.0, 0.1}}) {
        SCOPED_TRACE(expected.name);
        SceneOptions wanted = in_conditions({expected.name});
        wanted.ranges_m = {40.0};
        double noise_m2 = 0.0;
        double lateral_m2 = 0.0;
        double yaw_rad2 = 0.0;
        double boundary_cones = 0.0;
        double seen = 0.0;
        double missed = 0.0;
        const auto scenes = generate(track, poses, wanted);
        ASSERT_GT(scenes.size(), 3990u);  // a few scenes miss all but one cone of a side
        for (const auto& scene : scenes) {
            lateral_m2 += std::pow(scene.scene.pose.position.y(), 2);
            yaw_rad2 += std::pow(scene.scene.pose.yaw_rad, 2);
            seen += static_cast<double>(scene.scene.cones.size());
            missed += static_cast<double>(scene.missed.size());
            for (const ConeId id : scene.ground_truth->left) {
                const Point position = cone_of(scene, id).position;
                noise_m2 += std::pow(position.y() - 1.5, 2);  // the spacing is far above the noise
                noise_m2 += std::pow(position.x() - 5.0 * std::round(position.x() / 5.0), 2);
                boundary_cones += 1.0;
            }
            for (const Cone& cone : scene.missed) {
                EXPECT_TRUE(std::ranges::any_of(
                    track.cones, [&](const Cone& other) { return other.position == cone.position; }));
                EXPECT_TRUE(std::ranges::none_of(scene.scene.cones,
                                                 [&](const Cone& other) { return other.id == cone.id; }));
            }
        }
        const auto count = static_cast<double>(scenes.size());
        EXPECT_NEAR(std::sqrt(noise_m2 / (2.0 * boundary_cones)), expected.noise_m, 0.02 * expected.noise_m);
        EXPECT_NEAR(std::sqrt(lateral_m2 / count), expected.lateral_m, 0.05 * expected.lateral_m);
        EXPECT_NEAR(std::sqrt(yaw_rad2 / count) * 180.0 / std::numbers::pi, expected.yaw_degrees,
                    0.05 * expected.yaw_degrees);
        EXPECT_NEAR(missed / (seen + missed), expected.missed, 0.004);
    }
}

TEST(SceneConditions, MissedConesAreKeptOnlyWhereAConditionIsNamed) {
    SceneOptions wanted = options({0.0}, {40.0});
    wanted.miss_rate = 0.2;
    for (const auto& scene : generate(straight(), std::vector<Pose>(20, Pose{{7.0, 0.0}, 0.0}), wanted))
        EXPECT_THAT(scene.missed, IsEmpty());
}

}  // namespace
}  // namespace conelane
