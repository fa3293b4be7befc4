// The scenes of several tracks, whole and in shards.

#include "evaluation/formats/scene_set.hpp"

#include "evaluation/formats/track_spec.hpp"
#include "tests/support/cones_at.hpp"

namespace conelane {
namespace {

const std::vector<std::string> kTracks{"generated:circle", "generated:kidney@2"};

SceneOptions options_of(std::vector<double> ranges_m) {
    SceneOptions options{
        .false_positive_rates = {0.0, 0.2, 0.4}, .ranges_m = std::move(ranges_m), .every_m = 12.0};
    return options;
}

std::vector<std::string> ids(const std::vector<AnnotatedScene>& scenes) {
    return mapped(scenes, [](const AnnotatedScene& scene) { return scene.scene.id; });
}

TEST(SceneSet, SaysHowManyLapsAreMade) {
    LeftOutScenes left_out;
    std::vector<std::pair<std::size_t, std::size_t>> told;
    (void)make_scene_set(kTracks, options_of({20.0, 40.0}), {}, left_out,
                         [&](std::size_t done, std::size_t total) { told.emplace_back(done, total); });
    ASSERT_EQ(told.size(), 12U);  // two tracks, three rates, two ranges
    for (std::size_t i = 0; i < told.size(); ++i) EXPECT_EQ(told[i], std::pair(i, std::size_t{12}));
}

TEST(SceneSet, ShardsHoldEveryCountThLap) {
    // At a range of 2 m, no pose sees two cones of both sides: six of the eighteen laps have no scene.
    const SceneOptions options = options_of({20.0, 2.0, 40.0});
    const SceneSet whole = make_scene_set(kTracks, options);
    const std::vector<std::size_t> starts = lap_starts(whole.scenes);
    ASSERT_EQ(starts.size(), 12u + 1u);
    constexpr std::size_t kShards = 5;
    for (std::size_t index = 0; index < kShards; ++index) {
        std::vector<AnnotatedScene> expected;
        for (std::size_t lap = index; lap + 1 < starts.size(); lap += kShards) {
            for (std::size_t i = starts[lap]; i < starts[lap + 1]; ++i) expected.push_back(whole.scenes[i]);
        }
        const SceneSet shard = make_scene_set(kTracks, options, {index, kShards});
        EXPECT_EQ(ids(shard.scenes), ids(expected));
        EXPECT_EQ(shard.tracks.size(), kTracks.size());
        for (std::size_t i = 0; i < expected.size(); ++i) {
            ASSERT_EQ(shard.scenes[i].scene.cones.size(), expected[i].scene.cones.size());
            for (std::size_t cone = 0; cone < expected[i].scene.cones.size(); ++cone) {
                EXPECT_EQ(shard.scenes[i].scene.cones[cone].id, expected[i].scene.cones[cone].id);
                EXPECT_EQ(shard.scenes[i].scene.cones[cone].position, expected[i].scene.cones[cone].position);
            }
            EXPECT_EQ(shard.scenes[i].ground_truth, expected[i].ground_truth);
        }
    }
}

TEST(SceneSet, AShardBeyondTheLapsIsEmpty) {
    EXPECT_TRUE(make_scene_set(kTracks, options_of({20.0}), {6, 7}).scenes.empty());
    EXPECT_FALSE(make_scene_set(kTracks, options_of({20.0}), {5, 7}).scenes.empty());
}

TEST(SceneSet, NoSceneAtAllIsAnErrorInEveryShard) {
    EXPECT_THROW((void)make_scene_set(kTracks, options_of({2.0})), std::exception);
    EXPECT_THROW((void)make_scene_set(kTracks, options_of({2.0}), {1, 2}), std::exception);
}

/// A lane by its cones, ids in the order of the arguments.
AnnotatedScene with_truth(const std::vector<Point>& left, const std::vector<Point>& right, bool closed) {
    AnnotatedScene scene;
    Lane lane;
    lane.closed = closed;
    for (const auto& [side, run] : {std::pair{&left, &lane.left}, {&right, &lane.right}}) {
        for (const Point& position : *side) {
            run->push_back(static_cast<ConeId>(scene.scene.cones.size()));
            scene.scene.cones.push_back({.id = run->back(), .position = position});
        }
    }
    scene.ground_truth = lane;
    return scene;
}
bool degenerate(const std::vector<Point>& left, const std::vector<Point>& right, bool closed = false) {
    const AnnotatedScene scene = with_truth(left, right, closed);
    return is_degenerate(*scene.ground_truth, scene.scene);
}

TEST(DegenerateTruth, LanesOfAnyShapeAreNotDegenerate) {
    constexpr double kTurn = 2.0 * std::numbers::pi;
    EXPECT_FALSE(degenerate({{0, 2}, {5, 2}}, {{0, -2}, {5, -2}}));
    EXPECT_FALSE(degenerate({{0, 2}, {5, 2}}, {{0, -2}, {5, -2}, {10, -2}})) << "one ends earlier";
    EXPECT_FALSE(degenerate({{0, 2}, {15, 2}}, {{0, -2}, {5, -2}, {10, -2}, {15, -2}})) << "cones missed";
    EXPECT_FALSE(degenerate(tests::ring(1.0, 2, 0.0, 3.0), tests::ring(5.0, 8, 0.0, 3.0))) << "a tight bend";
    EXPECT_FALSE(degenerate(tests::ring(9.0, 12), tests::ring(12.0, 16), true));
    EXPECT_FALSE(degenerate(tests::ring(12.0, 16, 0.0, -kTurn), tests::ring(9.0, 12, 0.0, -kTurn), true))
        << "the other way";
}

TEST(DegenerateTruth, ABoundaryThatContinuesBesideAnotherLegIsDegenerate) {
    // The left boundary ends after 15 m; the right one turns around its end and comes back on its other side.
    const std::vector<Point> left{{0, 0}, {5, 0}, {10, 0}, {15, 0}};
    std::vector<Point> right{{0, -3}, {5, -3}, {10, -3}, {15, -3}, {20, -3}, {22, 0}, {20, 3}};
    EXPECT_FALSE(degenerate(left, {right.begin(), right.begin() + 4}));
    for (double x = 15.0; x >= 0.0; x -= 5.0) right.emplace_back(x, 3.0);
    for (double x = 0.0; x <= 60.0; x += 5.0) right.emplace_back(x, 9.0);
    EXPECT_TRUE(degenerate(left, right));
    EXPECT_TRUE(degenerate({{0, -2}, {5, -2}}, {{0, 2}, {5, 2}})) << "sides swapped";
}

/// Ids contain the pose, and every other scene keeps its own id.
TEST(SceneSet, OnlyScenesWithADegenerateTruthAreLeftOut) {
    SceneOptions options = options_of({30.0});
    options.every_m = 22.0;
    LeftOutScenes left_out;
    const SceneSet set = make_scene_set({"generated:tight_hairpins"}, options, {}, left_out);
    EXPECT_EQ(left_out, (LeftOutScenes{{"tight_hairpins",
                                        {"tight_hairpins/pose_0001/fp_0.00/range_30",
                                         "tight_hairpins/pose_0001/fp_0.20/range_30",
                                         "tight_hairpins/pose_0001/fp_0.40/range_30"}}}));
    const std::vector<std::string> made = ids(set.scenes);
    EXPECT_THAT(made, testing::IsSupersetOf({"tight_hairpins/pose_0000/fp_0.00/range_30",
                                             "tight_hairpins/pose_0002/fp_0.40/range_30"}));
    for (const AnnotatedScene& scene : set.scenes) ASSERT_TRUE(scene.ground_truth) << scene.scene.id;
    const Track track = load_tracks("generated:tight_hairpins").front();
    EXPECT_EQ(ids(generate_scenes(track, options)), made) << "the library leaves out the same ones";
}

TEST(TrackLaps, ALapOfDegenerateTruthsIsEmpty) {
    Track track;
    track.name = "swapped";
    track.closed = false;
    for (int i = 0; i < 4; ++i) {
        for (const double y : {-2.0, 2.0}) {
            auto& side = y < 0.0 ? track.left : track.right;
            side.push_back(track.cones.size());
            track.cones.push_back({.id = static_cast<ConeId>(track.cones.size()), .position = {4.0 * i, y}});
        }
    }
    const SceneOptions options = options_of({20.0});
    const std::vector<Pose> poses{{{0.0, 0.0}, 0.0}};
    const TrackLaps laps(track, poses, options);
    for (std::size_t lap = 0; lap < laps.size(); ++lap) EXPECT_TRUE(laps.is_empty(lap));
    EXPECT_TRUE(generate_scenes(track, poses, options).empty());
}

TEST(TrackLaps, KnowsWhichLapsAreEmpty) {
    const SceneOptions options = options_of({20.0, 2.0});
    Track track;  // two cones a side, all ahead of the one pose
    track.name = "short";
    track.closed = false;
    for (const Point& position : {Point{1, 2}, Point{5, 2}, Point{1, -2}, Point{5, -2}})
        track.cones.push_back({.id = static_cast<ConeId>(track.cones.size()), .position = position});
    track.left = {0, 1};
    track.right = {2, 3};
    const std::vector<Pose> poses{{{100.0, 0.0}, 0.0}, {{0.0, 0.0}, 0.0}};
    const TrackLaps laps(track, poses, options);
    ASSERT_EQ(laps.size(), 6u);
    for (std::size_t lap = 0; lap < laps.size(); ++lap) {
        EXPECT_EQ(laps.is_empty(lap), laps.make(lap).empty());
        EXPECT_EQ(laps.is_empty(lap), lap >= 3);
    }
}

}  // namespace
}  // namespace conelane
