#include "tests/support/refusal.hpp"
#include "tests/support/toy_track_scenes.hpp"

namespace conelane {
namespace {

/// The false positives of a scene: its cones that are not cones of the track.
std::vector<Cone> false_positives(const AnnotatedScene& scene, const Track& track) {
    std::vector<Cone> result;
    for (const Cone& cone : scene.scene.cones) {
        if (std::ranges::find(track.cones, cone.position, &Cone::position) == track.cones.end())
            result.push_back(cone);
    }
    return result;
}

TEST(PersistentFalsePositives, KeepIdAndPlaceAlongALap) {
    const Track track = circle();
    SceneOptions wanted = options({0.5}, {15.0});
    wanted.persistent = true;
    wanted.with_color = true;
    const auto scenes = generate_scenes(track, wanted);
    ASSERT_GT(scenes.size(), 50u);
    EXPECT_EQ(scenes[3].scene.id, "circle/pose_0003/fp_0.50/range_15/persist");
    std::map<ConeId, Cone> known;
    std::map<ConeId, int> views;
    for (const auto& scene : scenes) {
        const std::vector<Cone> seen = false_positives(scene, track);
        for (const Cone& cone : seen) {
            const auto [first, is_new] = known.try_emplace(cone.id, cone);
            EXPECT_EQ(first->second.position, cone.position);
            EXPECT_EQ(first->second.color, cone.color);
            ++views[cone.id];
        }
        // All of them that are in view are seen.
        for (const auto& [id, cone] : known) {
            const bool in_view = scene.scene.pose.ahead_m(cone.position) >= 0.0 &&
                                 (cone.position - scene.scene.pose.position).norm() <= 15.0;
            EXPECT_EQ(in_view, std::ranges::find(seen, id, &Cone::id) != seen.end()) << id;
        }
    }
    EXPECT_GT(known.size(), 20u);
    EXPECT_TRUE(std::ranges::any_of(views, [](const auto& entry) { return entry.second > 10; }));
    for (const Cone& cone : scenes[0].scene.cones) EXPECT_THAT(cone.id, AllOf(Ge(0), Lt(10'000)));
}

TEST(PersistentFalsePositives, AreAsDenseAsFreshOnes) {
    const Track track = circle();
    for (const auto& [rate, miss_rate] : {std::pair{0.1, 0.0}, std::pair{0.3, 0.1}, std::pair{0.5, 0.0}}) {
        SCOPED_TRACE(rate);
        double fresh = 0.0;
        double persistent = 0.0;
        for (std::uint64_t seed = 0; seed < 400; ++seed) {
            SceneOptions wanted = options({rate}, {15.0});
            wanted.seed = seed;
            wanted.miss_rate = miss_rate;
            for (const auto& scene : generate_scenes(track, wanted))
                fresh += static_cast<double>(false_positives(scene, track).size());
            wanted.persistent = true;
            for (const auto& scene : generate_scenes(track, wanted))
                persistent += static_cast<double>(false_positives(scene, track).size());
        }
        EXPECT_NEAR(persistent / fresh, 1.0, 0.05);
    }
}

TEST(PersistentFalsePositives, BytesDependNeitherOnThreadsNorOnOtherScenes) {
    SceneOptions wanted = in_conditions({"paper", "harsh"}, 0.3);
    wanted.persistent = true;
    wanted.ranges_m = {15.0, 20.0};
    const Track track = circle();
    const auto scenes = generate_scenes(track, wanted);
    wanted.threads = 2;
    EXPECT_EQ(bytes(generate_scenes(track, wanted)), bytes(scenes));
    // A single pose of one lap.
    wanted.conditions = {"harsh"};
    wanted.ranges_m = {20.0};
    wanted.every_m = 2.2;
    const auto alone = generate_scenes(track, wanted);
    const auto same = std::ranges::find(scenes, alone.front().scene.id,
                                        [](const AnnotatedScene& scene) { return scene.scene.id; });
    ASSERT_NE(same, scenes.end());
    EXPECT_EQ(bytes({alone.front()}), bytes({*same}));
}

TEST(PersistentFalsePositives, MoreThanTheNumberOfIdsAreRefused) {
    SceneOptions wanted = options({0.99}, {30.0});
    wanted.persistent = true;
    EXPECT_THAT(refusal([&] { (void)generate_scenes(straight(), wanted); }),
                testing::HasSubstr("fp: 0.99 gives"));
}

}  // namespace
}  // namespace conelane
