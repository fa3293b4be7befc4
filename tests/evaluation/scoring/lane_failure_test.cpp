#include "evaluation/scoring/lane_failure.hpp"

#include "tests/support/straight_scene.hpp"

namespace conelane {
namespace {

std::optional<LaneFailure> failure_of(const AnnotatedScene& scene, const LaneAnswer& answer,
                                      const TrackBoundaries* track = &kTrack) {
    const SceneScore score = conelane::score(scene, answer, kLatency_ms, std::nullopt, track);
    const bool is_found = answer.status == LaneStatus::found;
    return lane_failure(scene, is_found ? outline_of(answer.lane, scene.scene) : LaneOutline{}, score, track);
}

std::optional<LaneFailure> failure_of(const AnnotatedScene& scene, const Lane& lane,
                                      const TrackBoundaries* track = &kTrack) {
    return failure_of(scene, found(lane), track);
}

/// A hairpin. The car drives in +x between y = 0 (right, ids 101 to 106) and y = 3 (left, 1 to 6), cones
/// every 4 m up to x = 20; there the lane turns left and comes back between y = 6 (left, 9 to 14) and y = 9
/// (right).
struct Hairpin {
    AnnotatedScene scene;
    TrackBoundaries track{{}, {}, false};

    Hairpin() {
        Lane truth;
        const auto add = [&](std::vector<Point>& boundary, std::vector<ConeId>& run, ConeId id,
                             const Point& at) {
            scene.scene.cones.push_back({.id = id, .position = at});
            boundary.push_back(at);
            run.push_back(id);
        };
        for (int i = 0; i < 6; ++i) {
            add(track.left, truth.left, 1 + i, {4.0 * i, 3});
            add(track.right, truth.right, 101 + i, {4.0 * i, 0});
        }
        add(track.left, truth.left, 7, {21.5, 4.5});
        for (int i = 0; i < 5; ++i) {
            const double angle = std::numbers::pi * (i - 2) / 5.0;
            add(track.right, truth.right, 107 + i, {20 + 4.5 * std::cos(angle), 4.5 + 4.5 * std::sin(angle)});
        }
        for (int i = 0; i < 6; ++i) {
            add(track.left, truth.left, 9 + i, {20.0 - 4.0 * i, 6});
            add(track.right, truth.right, 112 + i, {20.0 - 4.0 * i, 9});
        }
        scene.scene.id = "hairpin";
        scene.scene.pose = {{-1, 1.5}, 0.0};
        scene.ground_truth = truth;
    }
};

TEST(LaneFailure, AUsableLaneHasNone) {
    const AnnotatedScene scene = straight_scene();
    EXPECT_FALSE(failure_of(scene, *scene.ground_truth));
    EXPECT_FALSE(failure_of(scene, truncated(scene, 6))) << "20 m are enough";
    EXPECT_FALSE(failure_of(scene, truncated(scene, 2), nullptr)) << "usable is unknown without boundaries";
}

TEST(LaneFailure, NothingFoundAndErrors) {
    LaneAnswer answer{.status = LaneStatus::none};
    EXPECT_EQ(failure_of(straight_scene(), answer), LaneFailure::nothing_found);
    answer.status = LaneStatus::error;
    EXPECT_EQ(failure_of(straight_scene(), answer), LaneFailure::error);
}

TEST(LaneFailure, FalseCone) {
    AnnotatedScene scene = straight_scene();
    add_cone(scene, 50, {10, 4});  // 2.25 m left of the left boundary
    Lane lane = with_inserted(scene, 3, 50);
    EXPECT_EQ(failure_of(scene, lane), LaneFailure::false_cone);
    lane.left.resize(4);  // whether the lane comes back has no effect
    EXPECT_EQ(failure_of(scene, lane), LaneFailure::false_cone);
}

TEST(LaneFailure, WrongStartIsWhateverTheFirstVertexIs) {
    AnnotatedScene scene = straight_scene();
    add_cone(scene, 50, {1, 5});
    EXPECT_EQ(failure_of(scene, with_inserted(scene, 0, 50)), LaneFailure::wrong_start);
    Lane swapped = *scene.ground_truth;
    std::swap(swapped.left, swapped.right);
    EXPECT_EQ(failure_of(scene, swapped), LaneFailure::wrong_start);
}

TEST(LaneFailure, TheFirstPlaceOfBothSidesDecides) {
    AnnotatedScene scene = straight_scene();
    add_cone(scene, 50, {14, 4});
    Lane lane = with_inserted(scene, 4, 50);              // on the left after 12 m, a false cone
    lane.right = {101, 102, 3, 104, 105, 106, 107, 108};  // on the right after 4 m, a cone of the left
    EXPECT_EQ(failure_of(scene, lane), LaneFailure::wrong_side);
    lane.right = scene.ground_truth->right;
    EXPECT_EQ(failure_of(scene, lane), LaneFailure::false_cone);
}

TEST(LaneFailure, WrongLegOfAHairpin) {
    const Hairpin hairpin;
    // From the left cone at x = 8 to the way back, 3 m away.
    const Lane over{{1, 2, 3, 12, 13}, {101, 102, 103, 104, 105}, false};
    EXPECT_EQ(failure_of(hairpin.scene, over, &hairpin.track), LaneFailure::wrong_leg);
    // From the right boundary to the left one of the way back, behind the end of the ground truth there.
    AnnotatedScene cut = hairpin.scene;
    cut.ground_truth->left.resize(6);
    cut.ground_truth->right.resize(6);
    const Lane across{{1, 2, 3, 4, 5}, {101, 102, 12, 13}, false};
    EXPECT_EQ(failure_of(cut, across, &hairpin.track), LaneFailure::wrong_leg);
    EXPECT_EQ(failure_of(hairpin.scene, across, &hairpin.track), LaneFailure::wrong_side)
        << "there it belongs to the stretch that is seen";
}

TEST(LaneFailure, GoingBackIsAWrongLegToo) {
    const AnnotatedScene scene = straight_scene();
    EXPECT_EQ(failure_of(scene, {{1, 2, 3, 4, 2}, {101, 102, 103, 104}, false}), LaneFailure::wrong_leg);
}

TEST(LaneFailure, ConeSkippedWhereTheBoundaryTakesADetour) {
    // The left boundary bulges out by 10 m between x = 8 and x = 12; the lane goes straight on.
    AnnotatedScene scene = straight_scene();
    add_cone(scene, 60, {8, 11.75});
    add_cone(scene, 61, {12, 11.75});
    scene.ground_truth->left = {1, 2, 3, 60, 61, 4, 5, 6, 7, 8, 9, 10};
    TrackBoundaries track = kTrack;
    track.left = {{-20, 1.75}, {8, 1.75}, {8, 11.75}, {12, 11.75}, {12, 1.75}, {80, 1.75}};
    // Without the cone at x = 12: it is the corner itself, where the boundary still comes back.
    const Lane past_the_corner{{1, 2, 3, 5, 6, 7}, {101, 102, 103, 104, 105, 106, 107}, false};
    EXPECT_EQ(failure_of(scene, past_the_corner, &track), LaneFailure::cone_skipped);
}

TEST(LaneFailure, ShortLanesStopEarlyOrBeforeAGap) {
    AnnotatedScene scene = straight_scene();
    EXPECT_EQ(failure_of(scene, truncated(scene, 3)), LaneFailure::stopped_early);
    // The left cone at x = 12 was missed: the truth steps from 8 m to 16 m, twice its median step.
    std::erase(scene.ground_truth->left, 4);
    std::erase_if(scene.scene.cones, [](const Cone& cone) { return cone.id == 4; });
    EXPECT_EQ(failure_of(scene, truncated(scene, 3)), LaneFailure::gap_not_bridged);
    EXPECT_EQ(failure_of(scene, truncated(scene, 2)), LaneFailure::stopped_early)
        << "before it came to the gap";
}

TEST(LaneFailure, AShortLaneThatBeginsTooFarAheadHasAWrongStart) {
    AnnotatedScene scene = straight_scene();
    scene.ground_truth->left.resize(6);  // 20 m, of which 15 m must be there
    scene.ground_truth->right.resize(6);
    const Lane late{{4, 5, 6}, {104, 105, 106}, false};
    EXPECT_EQ(failure_of(scene, late), LaneFailure::wrong_start);
}

TEST(LaneFailure, AShortLaneThatCutsTheInsideSkipsCones) {
    // The left boundary makes two teeth, 21.5 m long; the right one is straight, 8 m.
    AnnotatedScene scene = straight_scene();
    TrackBoundaries track = kTrack;
    track.left = {{0, 1.75}, {2, 6.75}, {4, 1.75}, {6, 6.75}, {8, 1.75}};
    track.right = {{0, -1.75}, {8, -1.75}};
    scene.scene.cones.clear();
    scene.ground_truth = Lane{{1, 2, 3, 4, 5}, {101, 102}, false};
    for (int i = 0; i < 5; ++i) add_cone(scene, 1 + i, track.left[static_cast<std::size_t>(i)]);
    add_cone(scene, 101, {0, -1.75});
    add_cone(scene, 102, {8, -1.75});
    // After the teeth, each foot moves by 10.8 m, which is not a leap: at most 2 * 4 m + 3 m.
    const Lane straight_on{{1, 3, 5}, {101, 102}, false};
    EXPECT_EQ(failure_of(scene, straight_on, &track), LaneFailure::cone_skipped);
}

TEST(LaneFailure, ADrivenPathDoesNotTellWhy) {
    AnnotatedScene scene = straight_scene();
    scene.ground_truth.reset();
    scene.range_m = 40.0;
    const TrackBoundaries run{{}, {}, false, {{-2, 0}, {2, 0}, {10, 0}, {20, 0}, {36, 0}}};
    EXPECT_EQ(failure_of(scene, {{1, 2}, {101, 102}, false}, &run), LaneFailure::stopped_early);
    const Lane crossing{{1, 2, 3, 104}, {101, 102, 103, 105, 106}, false};
    EXPECT_EQ(failure_of(scene, crossing, &run), LaneFailure::leaves_path);
    const Lane swapped{{101, 102, 103}, {1, 2, 3}, false};
    EXPECT_EQ(failure_of(scene, swapped, &run), LaneFailure::wrong_start);
}

TEST(LaneFailure, ACentreLineAloneDoesNotTellWhy) {
    const AnnotatedScene scene = straight_scene();
    const std::vector<Point> off{{0, 0}, {5, 0}, {10, 3}};
    EXPECT_EQ(lane_failure(scene, {}, score_centre_line(scene, off, kLatency_ms, &kTrack), &kTrack),
              LaneFailure::leaves_path);
    const std::vector<Point> stub{{0, 0}, {5, 0}};
    EXPECT_EQ(lane_failure(scene, {}, score_centre_line(scene, stub, kLatency_ms, &kTrack), &kTrack),
              LaneFailure::stopped_early);
}

TEST(LaneFailure, AllHaveDifferentNames) {
    std::set<std::string> names;
    for (std::size_t i = 0; i < kLaneFailureCount; ++i) names.emplace(to_string(static_cast<LaneFailure>(i)));
    EXPECT_EQ(names.size(), kLaneFailureCount);
    EXPECT_FALSE(names.contains(""));
}

}  // namespace
}  // namespace conelane
