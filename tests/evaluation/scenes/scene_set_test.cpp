// The scenes of several tracks, whole and in shards.

#include "evaluation/scenes/scene_set.hpp"

#include "experiments/comparison/runner.hpp"

#include <cstddef>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace conelane {
namespace {

const std::vector<std::string> kTracks{"generated:circle", "generated:kidney@2"};

SceneOptions options_of(std::vector<double> ranges_m) {
    SceneOptions options;
    options.false_positive_rates = {0.0, 0.2, 0.4};
    options.ranges_m = std::move(ranges_m);
    options.every_m = 12.0;
    return options;
}

std::vector<std::string> ids(const std::vector<AnnotatedScene>& scenes) {
    std::vector<std::string> all;
    for (const AnnotatedScene& scene : scenes) all.push_back(scene.scene.id);
    return all;
}

TEST(SceneSet, ShardsHoldEveryCountThLap) {
    // Nobody sees two cones of both sides within 2 m: six of the eighteen laps have no scene.
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

TEST(TrackLaps, KnowsWhichLapsAreEmpty) {
    const SceneOptions options = options_of({20.0, 2.0});
    Track track;  // two cones a side, all ahead of the one pose
    track.name = "short";
    track.closed = false;
    for (const Point& position : {Point{1, 2}, Point{5, 2}, Point{1, -2}, Point{5, -2}}) {
        track.cones.push_back({.id = static_cast<ConeId>(track.cones.size()), .position = position});
    }
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
