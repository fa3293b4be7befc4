// What the car sees of a track, and the ground truth in it.

#include "tests/support/toy_track_scenes.hpp"

namespace conelane {
namespace {

/// The index in its boundary of each cone of a run.
std::vector<std::size_t> places(const AnnotatedScene& scene, const std::vector<ConeId>& run,
                                const Track& track, const std::vector<std::size_t>& side) {
    std::vector<std::size_t> result;
    for (const ConeId id : run) {
        const Point position = cone_of(scene, id).position;
        result.push_back(static_cast<std::size_t>(
            std::ranges::find_if(side, [&](std::size_t i) { return track.cones[i].position == position; }) -
            side.begin()));
    }
    return result;
}

TEST(SceneGeneration, TheCarSeesTheHalfDiscAheadAndTheRunsOfItsBoundaries) {
    const auto scenes = generate(straight(), {{{7.0, 0.0}, 0.0}}, options({0.0}, {15.0}));
    ASSERT_THAT(scenes, SizeIs(1));
    const AnnotatedScene& scene = scenes.front();
    EXPECT_EQ(scene.scene.id, "toy/pose_0000/fp_0.00/range_15");
    EXPECT_EQ(scene.track, "toy");
    EXPECT_EQ(scene.false_positive_rate, 0.0);
    EXPECT_EQ(scene.range_m, 15.0);
    EXPECT_EQ(scene.seed, 0u);
    EXPECT_EQ(scene.scene.pose.position, Point(7.0, 0.0));
    // Cones from x = 10 to x = 20 on each side, and the stray point; x = 25 is 18 m ahead, x = 5 behind.
    EXPECT_THAT(scene.scene.cones, SizeIs(7));
    EXPECT_THAT(xs(scene, scene.ground_truth->left), ElementsAre(10, 15, 20));
    EXPECT_THAT(xs(scene, scene.ground_truth->right), ElementsAre(10, 15, 20));
    EXPECT_EQ(cone_of(scene, scene.ground_truth->left[0]).position.y(), 1.5);
    EXPECT_FALSE(scene.ground_truth->closed);
}

TEST(SceneGeneration, TheHalfDiscIsClosed) {
    // From (10, -1.5) the right cone at x = 10 is at the car itself, the left one exactly abeam, and the
    // right one at x = 25 exactly on the rim.
    const auto scenes = generate(straight(), {{{10.0, -1.5}, 0.0}}, options({0.0}, {15.0}));
    ASSERT_THAT(scenes, SizeIs(1));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->left), ElementsAre(10, 15, 20));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->right), ElementsAre(10, 15, 20, 25));
}

TEST(SceneGeneration, AVisibleConeBehindTheFootPointStartsNoRun) {
    // Turned left by 45 degrees at (11, 0), the car still sees the left cone at (10, 1.5), but has passed it.
    const auto scenes = generate(straight(), {{{11.0, 0.0}, std::numbers::pi / 4}}, options({0.0}, {12.0}));
    ASSERT_THAT(scenes, SizeIs(1));
    EXPECT_TRUE(std::ranges::any_of(scenes[0].scene.cones,
                                    [](const Cone& cone) { return cone.position == Point(10.0, 1.5); }));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->left), ElementsAre(15, 20));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->right), ElementsAre(15, 20));
}

TEST(SceneGeneration, FarEndsAreEvened) {
    // The right boundary ends at x = 20. The left cone at x = 25 is 5.8 m from there, that at x = 30 10.4 m.
    const auto scenes = generate(straight(95.0, 20.0), {{{7.0, 0.0}, 0.0}}, options({0.0}, {40.0}));
    ASSERT_THAT(scenes, SizeIs(1));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->left), ElementsAre(10, 15, 20, 25));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->right), ElementsAre(10, 15, 20));
}

TEST(SceneGeneration, AnOpenCourseEndsAndShortRunsGiveNoScene) {
    std::vector<Pose> poses;
    for (const double x : {84.0, 86.0, 91.0, 99.0}) poses.push_back({{x, 0.0}, 0.0});
    const auto scenes = generate(straight(), poses, options({0.0}, {30.0}));
    // From x = 91 and beyond, less than two cones a side are ahead.
    ASSERT_THAT(scenes, SizeIs(2));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->left), ElementsAre(85, 90, 95));
    EXPECT_THAT(xs(scenes[1], scenes[1].ground_truth->left), ElementsAre(90, 95));
    EXPECT_EQ(scenes[1].scene.id, "toy/pose_0001/fp_0.00/range_30");
}

TEST(SceneGeneration, RunsWrapOnAClosedCourse) {
    const Track track = circle();
    // At the angle of place 10.5, heading along the circle: places 11 and 0 lie ahead within 9 m.
    const double angle = 2.0 * std::numbers::pi * 10.5 / 12.0;
    const Pose pose{{10.0 * std::cos(angle), 10.0 * std::sin(angle)}, angle + std::numbers::pi / 2};
    const auto scenes = generate(track, {pose}, options({0.0}, {9.0}));
    ASSERT_THAT(scenes, SizeIs(1));
    EXPECT_THAT(places(scenes[0], scenes[0].ground_truth->left, track, track.left), ElementsAre(11, 0));
    EXPECT_THAT(places(scenes[0], scenes[0].ground_truth->right, track, track.right), ElementsAre(11, 0));
    EXPECT_FALSE(scenes[0].ground_truth->closed);
}

TEST(SceneGeneration, TheLaneIsClosedWhereBothRunsAreTheWholeBoundary) {
    const Track track = circle();
    // From (0, -20), looking along +y, everything is ahead; the feet are at place 9, angle -90 degrees.
    const std::vector<Pose> poses{{{0.0, -20.0}, std::numbers::pi / 2}};
    SceneOptions wanted = options({0.0}, {40.0, 29.0, 25.0});
    const auto scenes = generate(track, poses, wanted);
    ASSERT_THAT(scenes, SizeIs(2));
    const std::vector<std::size_t> all{9, 10, 11, 0, 1, 2, 3, 4, 5, 6, 7, 8};
    EXPECT_TRUE(scenes[0].ground_truth->closed);
    EXPECT_EQ(places(scenes[0], scenes[0].ground_truth->left, track, track.left), all);
    EXPECT_EQ(places(scenes[0], scenes[0].ground_truth->right, track, track.right), all);
    // At 29 m, the far side of the outer boundary is out of view and the inner boundary is whole: one side
    // goes all round, the other a third, which is degenerate. At 25 m both end.
    EXPECT_EQ(scenes[1].range_m, 25.0);
    EXPECT_FALSE(scenes[1].ground_truth->closed);

    // Missed cones do not make it open: the boundary is whole without them.
    wanted.miss_rate = 0.3;
    const auto missed = generate(track, poses, wanted);
    ASSERT_THAT(missed, SizeIs(2));
    EXPECT_THAT(missed[0].scene.cones, SizeIs(AllOf(Ge(4u), Lt(24u))));
    EXPECT_TRUE(missed[0].ground_truth->closed);
    EXPECT_EQ(missed[0].ground_truth->left.size() + missed[0].ground_truth->right.size(),
              missed[0].scene.cones.size());

    // A set of the nearest cones makes it open.
    wanted.miss_rate = 0.0;
    wanted.nearest = 14;
    const auto nearest = generate(track, poses, wanted);
    ASSERT_FALSE(nearest.empty());
    EXPECT_FALSE(nearest[0].ground_truth->closed);
}

TEST(SceneGeneration, TheNearestConesCutTheRuns) {
    SceneOptions wanted = options({0.0}, {30.0});
    wanted.nearest = 6;
    const auto scenes = generate(straight(), {{{7.0, -0.1}, 0.0}}, wanted);
    ASSERT_THAT(scenes, SizeIs(1));
    EXPECT_EQ(scenes[0].scene.id, "toy/pose_0000/fp_0.00/range_30/nearest_6");
    // Nearest: both at x = 10 (3 m), both at x = 15 (8 m), the stray point (9.5 m), the right one at x = 20.
    EXPECT_THAT(scenes[0].scene.cones, SizeIs(6));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->left), ElementsAre(10, 15));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->right), ElementsAre(10, 15, 20));
    wanted.nearest = 3;  // leaves one cone on a side
    EXPECT_THAT(generate(straight(), {{{7.0, -0.1}, 0.0}}, wanted), IsEmpty());
}

TEST(SceneGeneration, RunsGoOnPastMissedCones) {
    SceneOptions wanted = options({0.0}, {40.0});
    wanted.miss_rate = 0.2;
    bool gap = false;
    const std::vector<Pose> poses(50, Pose{{7.0, 0.0}, 0.0});
    for (const auto& scene : generate(straight(), poses, wanted)) {
        for (const auto* run : {&scene.ground_truth->left, &scene.ground_truth->right}) {
            const std::vector<double> x = xs(scene, *run);
            const double y = cone_of(scene, run->front()).position.y();
            // Every seen cone of the side up to the run's end is in the run.
            const auto up_to_end = std::ranges::count_if(scene.scene.cones, [&](const Cone& cone) {
                return cone.position.y() == y && cone.position.x() <= x.back();
            });
            EXPECT_EQ(static_cast<std::size_t>(up_to_end), x.size()) << scene.scene.id;
            EXPECT_TRUE(std::ranges::is_sorted(x));
            for (std::size_t i = 1; i < x.size(); ++i) gap = gap || x[i] - x[i - 1] > 5.0;
        }
    }
    EXPECT_TRUE(gap) << "no run had a missed cone inside";
}

}  // namespace
}  // namespace conelane
