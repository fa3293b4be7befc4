// Poses, ids, bytes and options of generated scenes.

#include "tests/support/refusal.hpp"
#include "tests/support/toy_track_scenes.hpp"

namespace conelane {
namespace {

TEST(SceneGeneration, WithoutPosesTheCarDrivesTheCentreLine) {
    SceneOptions wanted = options({0.0, 0.3}, {30.0});
    wanted.every_m = 2.0;
    const auto scenes = generate_scenes(straight(), wanted);
    // From x = 0 to x = 90, where the last two cones of each side are at or ahead of the car; twice.
    ASSERT_THAT(scenes, SizeIs(92));
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const Pose& pose = scenes[i].scene.pose;
        EXPECT_NEAR(pose.position.x(), 2.0 * static_cast<double>(i % 46), 1e-6);
        EXPECT_NEAR(pose.position.y(), 0.0, 1e-6);
        EXPECT_NEAR(pose.yaw_rad, 0.0, 1e-6);
        EXPECT_EQ(scenes[i].false_positive_rate, i < 46 ? 0.0 : 0.3);
    }
    wanted.every_m = 0.0;
    EXPECT_THROW(static_cast<void>(generate_scenes(straight(), wanted)), InvalidInput);
}

TEST(SceneGeneration, IdsShowRateRangeAndDisturbances) {
    SceneOptions wanted = options({0.3, 1.0 / 6.0, 0.125}, {30.0, 12.5});
    wanted.noise_sigma_m = 0.1;
    wanted.pose_noise_lateral_m = 0.3;
    wanted.pose_noise_yaw_rad = 0.05;
    wanted.miss_rate = 0.05;
    wanted.nearest = 12;
    const auto ids = mapped(generate(straight(), {{{30.0, 0.0}, 0.0}}, wanted),
                            [](const auto& scene) { return scene.scene.id; });
    const std::string rest = "/noise_0.1/pose_noise_0.3_0.05/miss_0.05/nearest_12";
    EXPECT_THAT(
        ids, ElementsAre("toy/pose_0000/fp_0.30/range_30" + rest,
                         "toy/pose_0000/fp_0.16666666666666666/range_30" + rest,
                         "toy/pose_0000/fp_0.125/range_30" + rest, "toy/pose_0000/fp_0.30/range_12.5" + rest,
                         "toy/pose_0000/fp_0.16666666666666666/range_12.5" + rest,
                         "toy/pose_0000/fp_0.125/range_12.5" + rest));
}

TEST(SceneGeneration, IdsAndOrderRevealNothing) {
    std::vector<Pose> poses;
    for (double x = 3.0; x < 60.0; x += 1.1) poses.push_back({{x, 0.0}, 0.0});
    SceneOptions wanted = options({0.0, 0.5}, {30.0});
    const Track track = straight();
    const auto scenes = generate(track, poses, wanted);
    std::map<std::pair<double, double>, ConeId> id_at;
    std::set<ConeId> ids_of_track;
    for (const auto& scene : scenes) {
        std::set<ConeId> ids;
        for (const Cone& cone : scene.scene.cones) {
            EXPECT_TRUE(ids.insert(cone.id).second) << "id " << cone.id << " twice in " << scene.scene.id;
            EXPECT_THAT(cone.id, AllOf(Ge(0), Lt(10'000)));
            const bool of_track = std::ranges::any_of(
                track.cones, [&](const Cone& other) { return other.position == cone.position; });
            if (!of_track) continue;
            const auto [known, is_new] = id_at.try_emplace({cone.position.x(), cone.position.y()}, cone.id);
            EXPECT_EQ(known->second, cone.id) << "a cone of the track changes its id along the lap";
            ids_of_track.insert(cone.id);
        }
    }
    EXPECT_EQ(ids_of_track.size(), id_at.size());
    // Neither ids nor order depend on the boundary.
    const auto& scene = scenes.front();
    EXPECT_FALSE(std::ranges::is_sorted(scene.ground_truth->left));
    EXPECT_FALSE(std::ranges::is_sorted(scene.scene.cones, {}, [](const Cone& c) { return c.position.x(); }));
    EXPECT_FALSE(std::ranges::is_sorted(scene.scene.cones, {}, &Cone::id));
    wanted.seed = 1;
    EXPECT_NE(generate(track, poses, wanted).front().ground_truth->left, scene.ground_truth->left);
}

TEST(SceneGeneration, BytesDependNeitherOnThreadsNorOnOtherScenes) {
    std::vector<Pose> poses;
    for (double x = 3.0; x < 40.0; x += 1.1) poses.push_back({{x, 0.1}, 0.02});
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        SCOPED_TRACE(seed);
        SceneOptions wanted = options({0.1, 0.3}, {30.0, 50.0});
        wanted.seed = seed;
        wanted.noise_sigma_m = 0.1;
        wanted.pose_noise_lateral_m = 0.2;
        wanted.miss_rate = 0.05;
        wanted.with_color = true;
        wanted.color_error_rate = 0.1;
        wanted.with_confidence = true;
        const auto scenes = generate(straight(), poses, wanted);
        ASSERT_EQ(scenes.size(), 4 * poses.size());
        wanted.threads = 4;
        EXPECT_EQ(bytes(generate(straight(), poses, wanted)), bytes(scenes));

        // One lap alone, and its first poses alone.
        wanted.false_positive_rates = {0.3};
        wanted.ranges_m = {50.0};
        const std::vector<AnnotatedScene> last_lap(scenes.end() - static_cast<std::ptrdiff_t>(poses.size()),
                                                   scenes.end());
        EXPECT_EQ(bytes(generate(straight(), poses, wanted)), bytes(last_lap));
        EXPECT_EQ(bytes(generate_scenes(straight(), std::span(poses).first(3), wanted)),
                  bytes({last_lap.begin(), last_lap.begin() + 3}));

        wanted.seed = seed + 1;
        EXPECT_NE(bytes(generate(straight(), poses, wanted)), bytes(last_lap));
    }
}

TEST(SceneGeneration, BytesAreTheSameOnEveryMachine) {
    // Fails after any change of the generator, of a distribution or of the order of draws.
    SceneOptions wanted = options({0.3}, {15.0});
    wanted.seed = 7;
    const auto scenes = generate(straight(), {{{7.0, 0.0}, 0.0}}, wanted);
    EXPECT_EQ(bytes(scenes),
              R"({"id":"toy/pose_0000/fp_0.30/range_15","pose":{"x":7.0,"y":0.0,"yaw":0.0},"cones":[)"
              R"({"id":8612,"x":12.0,"y":8.0,"color":"unknown","confidence":1.0},)"
              R"({"id":4623,"x":15.0,"y":1.5,"color":"unknown","confidence":1.0},)"
              R"({"id":1593,"x":20.0,"y":1.5,"color":"unknown","confidence":1.0},)"
              R"({"id":4136,"x":15.0,"y":-1.5,"color":"unknown","confidence":1.0},)"
              R"({"id":3095,"x":10.0,"y":1.5,"color":"unknown","confidence":1.0},)"
              R"({"id":7358,"x":8.944551,"y":-7.229613,"color":"unknown","confidence":1.0},)"
              R"({"id":4440,"x":10.0,"y":-1.5,"color":"unknown","confidence":1.0},)"
              R"({"id":3073,"x":15.577195,"y":4.455415,"color":"unknown","confidence":1.0},)"
              R"({"id":3140,"x":18.965502,"y":5.995767,"color":"unknown","confidence":1.0},)"
              R"({"id":3961,"x":20.0,"y":-1.5,"color":"unknown","confidence":1.0}],)"
              R"("ground_truth":{"left":[3095,4623,1593],"right":[4440,4136,3961],"closed":false},)"
              R"("track":"toy","false_positive_rate":0.3,"range":15.0,"seed":7})"
              "\n");
}

TEST(SceneGeneration, NamesOptionsOutOfRange) {
    static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    const auto colored = [](double error_rate, double unknown_rate) {
        return [=](SceneOptions& o) {
            o.with_color = true;
            o.color_error_rate = error_rate;
            o.color_unknown_rate = unknown_rate;
        };
    };
    for (const auto& [change, message] :
         std::vector<std::pair<std::function<void(SceneOptions&)>, std::string>>{
             {[](SceneOptions&) {}, "accepted"},
             {[](SceneOptions& o) { o.false_positive_rates = {}; }, "fp: must hold at least one value"},
             {[](SceneOptions& o) { o.false_positive_rates = {1.0}; }, "fp: must be in [0, 0.99]"},
             {[](SceneOptions& o) { o.false_positive_rates = {kNan}; }, "fp: must be in [0, 0.99]"},
             {[](SceneOptions& o) {
                  o.false_positive_rates = {0.3, 0.3};
              },
              "fp: 0.3 is there twice"},
             {[](SceneOptions& o) { o.ranges_m = {0.0}; }, "range: must be in [0.1, 1000]"},
             {[](SceneOptions& o) { o.every_m = 0.0; }, "every: must be in [0.01, 1000]"},
             {[](SceneOptions& o) { o.nearest = 0; }, "nearest: must be at least 1"},
             {[](SceneOptions& o) { o.noise_sigma_m = -1.0; }, "noise: must be in [0, 1000]"},
             {[](SceneOptions& o) { o.noise_by_range = 1.5; }, "noise-by-range: must be in [0, 1]"},
             {[](SceneOptions& o) { o.pose_noise_yaw_rad = kNan; }, "pose-noise: must be in [0, 1000]"},
             {[](SceneOptions& o) { o.miss_rate = 1.0; }, "miss: must be in [0, 1)"},
             {colored(1.5, 0.0), "color-wrong: must be in [0, 1]"},
             {colored(0.0, -0.5), "color-unknown: must be in [0, 1]"},
             {[](SceneOptions& o) { o.color_error_rate = 0.1; }, "color-wrong: needs scenes with colour"},
             {[](SceneOptions& o) { o.color_unknown_rate = 0.1; }, "color-unknown: needs scenes with colour"},
             {[](SceneOptions& o) { o.threads = 0; }, "threads: must be in [1, 1024]"},
             {[](SceneOptions& o) { o.conditions = {"rain"}; },
              "condition: 'rain' is not one of paper, car, harsh, slam"},
             {[](SceneOptions& o) {
                  o.conditions = {"car", "car"};
              },
              "condition: car is there twice"}}) {
        SceneOptions wanted = options({0.0}, {30.0});
        change(wanted);
        EXPECT_EQ(refusal([&] { validate(wanted); }), message);
    }

    const SceneOptions good = options({0.5}, {30.0});
    EXPECT_THROW(generate(straight(), {{{kNan, 0.0}, 0.0}}, good), InvalidInput);
    EXPECT_THROW(generate(straight(), {{{0.0, 0.0}, kNan}}, good), InvalidInput);
    EXPECT_THROW(generate(straight(), {{{1e12, 0.0}, 0.0}}, good), InvalidInput);
    EXPECT_THAT(generate(straight(), {}, good), IsEmpty());
    EXPECT_THAT(generate(Track{"empty", {}, {}, {}, true}, {{{0.0, 0.0}, 0.0}}, good), IsEmpty());
}

}  // namespace
}  // namespace conelane
