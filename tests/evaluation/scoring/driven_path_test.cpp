#include "conelane/invalid_input.hpp"
#include "evaluation/scoring/divergence.hpp"
#include "evaluation/scoring/score.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

/// A run along +x, 40 m long, past cones every 4 m at y = 1.5 (ids 0 to 10) and y = -1.5 (ids 100 to 110).
AnnotatedScene scene_of_a_run() {
    AnnotatedScene scene;
    scene.scene.id = "run";
    scene.range_m = 30.0;
    for (int i = 0; i <= 10; ++i) {
        scene.scene.cones.push_back({.id = i, .position = {4.0 * i, 1.5}});
        scene.scene.cones.push_back({.id = 100 + i, .position = {4.0 * i, -1.5}});
    }
    return scene;
}

std::vector<Point> straight_drive(double from_m, double to_m) {
    std::vector<Point> path;
    for (double x = from_m; x <= to_m; x += 1.0) path.emplace_back(x, 0.0);
    return path;
}

const TrackBoundaries kRun{{}, {}, false, straight_drive(-5, 40)};

Lane lane_of(int cones) {
    Lane lane;
    for (int i = 0; i < cones; ++i) {
        lane.left.push_back(i);
        lane.right.push_back(100 + i);
    }
    return lane;
}

SceneScore scored(const AnnotatedScene& scene, const Lane& lane) {
    LaneAnswer answer{.status = LaneStatus::found, .lane = lane};
    return score(scene, answer, 1.0, std::nullopt, &kRun);
}

TEST(DrivenPath, ShowsTheWayAheadWithinTheRange) {
    const AnnotatedScene scene = scene_of_a_run();
    const std::vector<Point> ahead = driven_ahead(scene.scene, kRun.driven, scene.range_m);
    EXPECT_EQ(ahead.front(), Point(0, 0));
    EXPECT_EQ(ahead.back(), Point(30, 0));
    EXPECT_EQ(driven_ahead(scene.scene, kRun.driven, std::nullopt).back(), Point(40, 0));
}

TEST(DrivenPath, EndsWhereNoConeIsSeenBesideIt) {
    AnnotatedScene scene = scene_of_a_run();
    std::erase_if(scene.scene.cones, [](const Cone& cone) { return cone.position.x() > 13.0; });
    EXPECT_EQ(driven_ahead(scene.scene, kRun.driven, scene.range_m).back(), Point(12, 0));
    std::erase_if(scene.scene.cones, [](const Cone& cone) { return cone.position.x() > 3.0; });
    EXPECT_FALSE(counts(scene, &kRun)) << "a cone at the start shows nothing of the way";
}

TEST(DrivenPath, TakesThePassInTheDirectionOfTheCar) {
    std::vector<Point> there_and_back = straight_drive(-5, 40);
    for (int x = 40; x >= -5; --x) there_and_back.emplace_back(x, 0.4);
    AnnotatedScene scene = scene_of_a_run();
    scene.scene.pose = {{10, 0.39}, 0.0};
    EXPECT_EQ(driven_ahead(scene.scene, there_and_back, 12.1).back(), Point(22, 0));
    scene.scene.pose = {{10, 8}, 0.0};
    EXPECT_TRUE(driven_ahead(scene.scene, there_and_back, 12.1).empty()) << "the car is not on the path";
}

TEST(DrivenPath, ALaneAroundItIsUsable) {
    const AnnotatedScene scene = scene_of_a_run();
    ASSERT_TRUE(counts(scene, &kRun));
    EXPECT_FALSE(counts(scene)) << "nothing is known of it without the run";
    const SceneScore result = scored(scene, lane_of(7));  // 24 m
    EXPECT_EQ(result.category, Category::near_ground_truth);
    EXPECT_DOUBLE_EQ(result.ground_truth_length_m, 30.0);
    EXPECT_TRUE(result.usable().value());
    EXPECT_FALSE(result.iou);
    EXPECT_FALSE(result.accuracy);
    EXPECT_FALSE(scored(scene, lane_of(2)).usable().value()) << "a stub";
    EXPECT_THROW((void)score(scene, {}, 1.0, std::nullopt, nullptr), InvalidInput);
}

TEST(DrivenPath, ALaneThatItCrossesIsWrong) {
    AnnotatedScene scene = scene_of_a_run();
    scene.scene.cones.push_back({.id = 50, .position = {14.5, -1.0}});
    Lane crossed = lane_of(7);
    crossed.left[4] = 50;  // the left boundary crosses the path between 12 m and 14.5 m
    const SceneScore near = scored(scene, crossed);
    EXPECT_EQ(near.category, Category::diverging_below_20);
    EXPECT_NEAR(near.divergence_distance_m.value(), 13.0, 1.0);
    EXPECT_FALSE(near.usable().value());

    scene.scene.cones.back().position = {25.5, -1.0};
    Lane late = lane_of(7);
    late.left.push_back(50);
    EXPECT_EQ(scored(scene, late).category, Category::diverging_from_20);
}

TEST(DrivenPath, ALaneBesideItIsWrongThoughNothingCrosses) {
    AnnotatedScene scene = scene_of_a_run();
    Lane beside;
    for (int i = 0; i < 7; ++i) {
        scene.scene.cones.push_back({.id = 200 + i, .position = {4.0 * i + 1.0, 5.0}});
        beside.left.push_back(200 + i);
        beside.right.push_back(i);  // the true left boundary
    }
    EXPECT_EQ(scored(scene, beside).category, Category::diverging_below_20);
    Lane swapped = lane_of(7);
    std::swap(swapped.left, swapped.right);
    EXPECT_EQ(scored(scene, swapped).category, Category::diverging_below_20);
}

}  // namespace
}  // namespace conelane
