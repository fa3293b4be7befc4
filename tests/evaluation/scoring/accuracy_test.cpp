#include "tests/support/straight_scene.hpp"

namespace conelane {
namespace {

TEST(Accuracy, NoTwoEdgesCross) {
    const AnnotatedScene scene = straight_scene();
    Lane changed_over = *scene.ground_truth;  // the sides are exchanged from the fourth cone on
    for (std::size_t i = 3; i < changed_over.left.size(); ++i)
        std::swap(changed_over.left[i], changed_over.right[i]);
    EXPECT_FALSE(scored(scene, changed_over).accuracy->crossings);
    EXPECT_TRUE(scored(scene, changed_over).accuracy->cones);
    EXPECT_TRUE(scored(scene, changed_over).accuracy->sides);

    AnnotatedScene loop = straight_scene();  // edges (1, 201) and (202, 2) of one boundary cross
    add_cone(loop, 201, {4, 3.75});
    add_cone(loop, 202, {0, 3.75});
    Lane looped = *loop.ground_truth;
    looped.left.insert(looped.left.begin() + 1, {201, 202});
    EXPECT_FALSE(scored(loop, looped).accuracy->crossings);
}

TEST(Accuracy, TheClosingEdgesOfAClosedLaneCountToo) {
    AnnotatedScene scene = straight_scene();
    add_cone(scene, 201, {40, -5});
    Lane lane = *scene.ground_truth;
    lane.left.push_back(201);
    EXPECT_TRUE(scored(scene, lane).accuracy->crossings);
    lane.closed = true;  // from (40, -5) back to (0, 1.75), over the right boundary
    EXPECT_FALSE(scored(scene, lane).accuracy->crossings);
}

TEST(Accuracy, BoundsOfTheWidthAreAllowed) {
    const auto width_kept = [](double width_m) {
        const AnnotatedScene scene = straight_scene(width_m);
        return scored(scene, *scene.ground_truth).accuracy->width;
    };
    EXPECT_TRUE(width_kept(2.5));
    EXPECT_FALSE(width_kept(2.49));
    EXPECT_TRUE(width_kept(6.5));
    EXPECT_FALSE(width_kept(6.51));
}

TEST(Accuracy, AVertexTooFarFromTheOtherBoundaryBreaksTheWidth) {
    const AnnotatedScene scene = straight_scene();
    Lane lane = *scene.ground_truth;
    lane.right.resize(9);  // the last left cone is sqrt(4^2 + 3.5^2) m away
    EXPECT_TRUE(scored(scene, lane).accurate());
    lane.right.resize(8);
    EXPECT_FALSE(scored(scene, lane).accuracy->width);
    std::swap(lane.left, lane.right);
    EXPECT_FALSE(scored(scene, lane).accuracy->width);
}

TEST(Accuracy, ABoundaryOfOneConeHasAWidthToo) {
    EXPECT_TRUE(scored(straight_scene(2.5), {{1}, {101}}).accuracy->width);
    EXPECT_FALSE(scored(straight_scene(2.49), {{1}, {101}}).accuracy->width);
    EXPECT_FALSE(scored(straight_scene(2.49), {{1, 2}, {101}}).accuracy->width);
}

TEST(Accuracy, ABoundaryWithoutConesHasNeitherSideNorWidth) {
    const SceneScore result = scored(straight_scene(), {{1, 2}, {}});
    EXPECT_FALSE(result.accuracy->sides);
    EXPECT_FALSE(result.accuracy->width);
}

TEST(Accuracy, TheCarIsBetweenTheBoundaries) {
    AnnotatedScene scene = straight_scene();
    const auto sides = [&] { return scored(scene, *scene.ground_truth).accuracy->sides; };
    scene.scene.pose.position = {10, 1.7};
    EXPECT_TRUE(sides());
    scene.scene.pose.position = {10, 1.75};
    EXPECT_FALSE(sides()) << "on the boundary";
    scene.scene.pose.position = {10, 3};
    EXPECT_FALSE(sides()) << "left of the lane";
    scene.scene.pose.position = {10, -3};
    EXPECT_FALSE(sides()) << "right of the lane";
    scene.scene.pose = {{10, 0}, std::numbers::pi};
    EXPECT_FALSE(sides()) << "against the driving direction";
}

TEST(Accuracy, IsHeldAgainstTheGroundTruthOfTheDetectorsConeSet) {
    const AnnotatedScene scene = straight_scene();
    const LaneAnswer four_pairs = found(truncated(scene, 4));
    const SceneScore of_eight = score(scene, four_pairs, kLatency_ms, 8, &kTrack);
    EXPECT_TRUE(of_eight.accurate());
    EXPECT_EQ(of_eight.category, Category::too_short) << "the other measures know all that is visible";
    EXPECT_FALSE(score(scene, four_pairs, kLatency_ms, 12, &kTrack).accurate());
    EXPECT_FALSE(score(scene, four_pairs, kLatency_ms, 3, &kTrack).accuracy)
        << "three cones hold no ground truth, so accuracy does not count";
}

}  // namespace
}  // namespace conelane
