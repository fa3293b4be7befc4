
#include "conelane/invalid_input.hpp"
#include "tests/support/straight_scene.hpp"

namespace conelane {
namespace {

TEST(Score, TheGroundTruthFedBack) {
    const AnnotatedScene scene = straight_scene();
    const SceneScore result = scored(scene, *scene.ground_truth);
    EXPECT_EQ(result.category, Category::ground_truth);
    EXPECT_TRUE(result.success());
    EXPECT_EQ(result.iou, 1.0);
    EXPECT_DOUBLE_EQ(result.lane_length_m, 36.0);
    EXPECT_DOUBLE_EQ(result.ground_truth_length_m, 36.0);
    EXPECT_TRUE(result.divergence_known);
    EXPECT_FALSE(result.divergence_distance_m);
    ASSERT_TRUE(result.accuracy);
    EXPECT_TRUE(result.accurate());
    EXPECT_FALSE(result.solved_to_optimality);
    EXPECT_FALSE(result.enumeration);
    EXPECT_DOUBLE_EQ(result.latency_ms, kLatency_ms);
}

TEST(Score, SwappedSides) {
    const AnnotatedScene scene = straight_scene();
    const SceneScore result = scored(scene, {scene.ground_truth->right, scene.ground_truth->left});
    EXPECT_EQ(result.category, Category::diverging_below_20);
    EXPECT_EQ(result.iou, 0.0);
    EXPECT_EQ(result.divergence_distance_m, 0.0);
    EXPECT_FALSE(result.success());
    EXPECT_TRUE(result.accuracy->cones);
    EXPECT_FALSE(result.accuracy->sides);
}

TEST(Score, ATruncatedLaneIsTooShortBelowThreeQuarters) {
    const AnnotatedScene scene = straight_scene();
    const SceneScore at_24_m = scored(scene, truncated(scene, 7));
    EXPECT_EQ(at_24_m.category, Category::too_short);
    EXPECT_TRUE(at_24_m.success());
    EXPECT_NEAR(at_24_m.iou.value(), 24.0 / 36.0, 1e-12);
    EXPECT_FALSE(at_24_m.accuracy->cones);
    EXPECT_EQ(scored(scene, truncated(scene, 8)).category, Category::near_ground_truth);

    Lane at_27_m = truncated(scene, 7);  // sides of 24 m and 30 m: three quarters exactly
    at_27_m.right.insert(at_27_m.right.end(), 111);
    AnnotatedScene longer = scene;
    add_cone(longer, 111, {30, -1.75});
    EXPECT_EQ(scored(longer, at_27_m).category, Category::near_ground_truth);
}

TEST(Score, OneFalsePositiveWithinAMetreIsNearGroundTruthAndAccurate) {
    AnnotatedScene scene = straight_scene();
    add_cone(scene, 201, {18, 2.25});
    add_cone(scene, 202, {22, 2.25});
    const Lane one = with_inserted(scene, 5, 201);
    const SceneScore result = scored(scene, one);
    EXPECT_EQ(result.category, Category::near_ground_truth);
    EXPECT_NEAR(result.iou.value(), 126.0 / 127.0, 1e-9) << "a triangle of 4 m by 0.5 m beside 36 m by 3.5 m";
    EXPECT_TRUE(result.accurate());

    Lane two = one;
    two.left.insert(two.left.begin() + 7, 202);
    EXPECT_FALSE(scored(scene, two).accuracy->cones);
    Lane replaced = one;
    std::erase(replaced.left, 5);
    EXPECT_FALSE(scored(scene, replaced).accuracy->cones) << "one wrong and one missed";
    Lane missed = *scene.ground_truth;
    std::erase(missed.left, 5);
    EXPECT_TRUE(scored(scene, missed).accurate());
    EXPECT_EQ(scored(scene, missed).category, Category::near_ground_truth);
}

TEST(Score, AFalsePositiveFartherOutDivergesAtTheConeBefore) {
    AnnotatedScene scene = straight_scene();
    add_cone(scene, 201, {18, 3});
    add_cone(scene, 202, {22, 3});
    const SceneScore at_16_m = scored(scene, with_inserted(scene, 5, 201));
    EXPECT_EQ(at_16_m.category, Category::diverging_below_20);
    EXPECT_EQ(at_16_m.divergence_distance_m, 16.0);
    EXPECT_TRUE(at_16_m.accurate()) << "one cone differs and the lane is wide enough everywhere";
    const SceneScore at_20_m = scored(scene, with_inserted(scene, 6, 202));
    EXPECT_EQ(at_20_m.category, Category::diverging_from_20);
    EXPECT_EQ(at_20_m.divergence_distance_m, 20.0);
    EXPECT_TRUE(at_20_m.success());

    Lane short_too = with_inserted(scene, 5, 201);
    short_too.left.resize(6);
    short_too.right.resize(6);
    EXPECT_EQ(scored(scene, short_too).category, Category::diverging_below_20) << "before too short";
}

TEST(Score, UsableIsWhatACarCanDriveBy) {
    const AnnotatedScene scene = straight_scene();  // a ground truth of 36 m
    EXPECT_TRUE(scored(scene, *scene.ground_truth).usable().value());
    EXPECT_TRUE(scored(scene, truncated(scene, 6)).usable().value()) << "20 m, the limit";
    EXPECT_FALSE(scored(scene, truncated(scene, 5)).usable().value()) << "16 m";
    const SceneScore stub = scored(scene, truncated(scene, 2));
    EXPECT_TRUE(stub.success()) << "a stub leaves no track";
    EXPECT_FALSE(stub.usable().value()) << "and nobody can drive by it";
    EXPECT_FALSE(score(scene, LaneAnswer{}, kLatency_ms, std::nullopt, &kTrack).usable().value());

    AnnotatedScene astray = scene;
    add_cone(astray, 201, {18, 3});
    add_cone(astray, 202, {22, 3});
    EXPECT_FALSE(scored(astray, with_inserted(astray, 5, 201)).usable().value()) << "wrong from 16 m on";
    EXPECT_TRUE(scored(astray, with_inserted(astray, 6, 202)).usable().value()) << "wrong from 20 m on";

    EXPECT_FALSE(
        score(scene, found(*scene.ground_truth), kLatency_ms, std::nullopt, nullptr).usable().has_value())
        << "unknown without the boundaries of the track";
}

TEST(Score, OfAShortGroundTruthThreeQuartersAreUsable) {
    AnnotatedScene scene = straight_scene();
    scene.ground_truth = truncated(scene, 5);  // 16 m
    EXPECT_TRUE(scored(scene, truncated(scene, 4)).usable().value()) << "12 m";
    EXPECT_FALSE(scored(scene, truncated(scene, 3)).usable().value()) << "8 m";
}

TEST(Score, AnOutlineOfPositionsIsScoredLikeItsCones) {
    const AnnotatedScene scene = straight_scene();
    const LaneOutline outline = outline_of(truncated(scene, 8), scene.scene);
    const SceneScore of_points = score_outline(scene, outline, kLatency_ms, &kTrack);
    const SceneScore of_cones = scored(scene, truncated(scene, 8));
    EXPECT_EQ(of_points.category, of_cones.category);
    EXPECT_EQ(of_points.iou, of_cones.iou);
    EXPECT_EQ(of_points.lane_length_m, of_cones.lane_length_m);
    EXPECT_FALSE(of_points.accuracy) << "accuracy counts cones";
    EXPECT_EQ(score_outline(scene, {}, kLatency_ms, &kTrack).category, Category::none);
}

TEST(Score, ACentreLineAloneIsUsableWhereItFollowsTheTrueOne) {
    const AnnotatedScene scene = straight_scene();  // the true one runs along y = 0 from x = 0 to 36
    const auto scored_line = [&](const std::vector<Point>& line) {
        return score_centre_line(scene, line, kLatency_ms, &kTrack);
    };
    const SceneScore good = scored_line({{-1, 0}, {10, 0.9}, {25, -0.9}});
    EXPECT_TRUE(good.usable().value());
    EXPECT_FALSE(good.iou);
    EXPECT_NEAR(good.lane_length_m, 25.0, 0.6);
    EXPECT_FALSE(scored_line({{-1, 0}, {10, 0}}).usable().value()) << "too short";
    const SceneScore past_the_end = scored_line({{0, 0}, {20, 0}, {40, 0}, {50, 30}});
    EXPECT_TRUE(past_the_end.usable().value());
    EXPECT_FALSE(past_the_end.divergence_distance_m) << "of what comes after the true one nothing is known";
    EXPECT_NEAR(past_the_end.lane_length_m, 36.0, 0.6);
    const SceneScore off = scored_line({{0, 0}, {8, 0}, {12, 1.2}, {30, 0}});
    EXPECT_EQ(off.category, Category::diverging_below_20);
    EXPECT_NEAR(off.divergence_distance_m.value(), 8.0 + 4.0 / 1.2, 0.2) << "also between its points";
    EXPECT_FALSE(scored_line({{-1, 0}, {-30, 0}}).usable().value()) << "backwards it follows nothing";
    EXPECT_FALSE(scored_line({{-1, 2}, {-1, 30}}).usable().value()) << "sideways";
    EXPECT_EQ(scored_line({}).category, Category::none);
    for (const auto& far : std::vector<std::vector<Point>>{{{36, 10}, {60, 10}},
                                                           {{-10, 10}, {60, 10}},
                                                           {{0, 0}, {100, 50}},
                                                           {{0, 0}, {18, 10}, {36, 0}},
                                                           {{36, 0}, {0, 0}},
                                                           {{0, 0}, {12, 0}, {0, 0}, {36, 0}},
                                                           {{100, 0}, {120, 0}},
                                                           {{0, 0}, {1e300, 1e308}}}) {
        const SceneScore score = scored_line(far);
        EXPECT_FALSE(score.usable().value()) << far.back().x() << ", " << far.back().y();
        EXPECT_EQ(score.category, Category::diverging_below_20);
    }
}

TEST(Score, ACentreLineMayNotCutFromOneArmOfAHairpinToTheOther) {
    AnnotatedScene scene = straight_scene();
    scene.ground_truth.reset();
    const TrackBoundaries run{{}, {}, false, {{0, 0}, {20, 0}, {20, 4}, {0, 4}}};
    const auto usable = [&](const std::vector<Point>& line) {
        return score_centre_line(scene, line, kLatency_ms, &run).usable().value();
    };
    EXPECT_TRUE(usable({{0, 0}, {20, 0}, {20, 4}, {10, 4}}));
    EXPECT_FALSE(usable({{0, 0}, {5, 0}, {5, 4}, {0, 4}})) << "all of its points are on the path";
}

TEST(Score, WithoutAnnotatedBoundariesDivergenceIsUnknown) {
    AnnotatedScene scene = straight_scene();
    add_cone(scene, 201, {18, 3});
    const SceneScore result =
        score(scene, found(with_inserted(scene, 5, 201)), kLatency_ms, std::nullopt, nullptr);
    EXPECT_FALSE(result.divergence_known);
    EXPECT_FALSE(result.divergence_distance_m);
    EXPECT_EQ(result.category, Category::near_ground_truth);
    EXPECT_EQ(score(scene, found(truncated(scene, 3)), kLatency_ms, std::nullopt, nullptr).category,
              Category::too_short);
}

/// A circuit of 24 cones a side about (0, 0), radii 20 m and 16.5 m, the car on it at (18, 0).
struct Circuit {
    AnnotatedScene scene;
    TrackBoundaries boundaries;
};
Circuit circuit(bool clockwise) {
    Circuit result;
    result.scene.scene.id = "circuit";
    result.scene.scene.pose = {{18, -1}, clockwise ? -std::numbers::pi / 2 : std::numbers::pi / 2};
    Lane ground_truth;
    ground_truth.closed = true;
    for (int i = 0; i < 24; ++i) {
        const double angle_rad = (clockwise ? -1 : 1) * i * std::numbers::pi / 12;
        const Point direction(std::cos(angle_rad), std::sin(angle_rad));
        const Point left = (clockwise ? 20.0 : 16.5) * direction;
        const Point right = (clockwise ? 16.5 : 20.0) * direction;
        result.scene.scene.cones.push_back({.id = i, .position = left});
        result.scene.scene.cones.push_back({.id = 100 + i, .position = right});
        result.boundaries.left.push_back(left);
        result.boundaries.right.push_back(right);
        ground_truth.left.push_back(i);
        ground_truth.right.push_back(100 + i);
    }
    result.scene.ground_truth = ground_truth;
    return result;
}

TEST(Score, AClosedCircuitInBothDrivingDirections) {
    for (const bool clockwise : {true, false}) {
        SCOPED_TRACE(clockwise ? "clockwise" : "counter-clockwise");
        const auto [scene, boundaries] = circuit(clockwise);
        const auto scored_here = [&, &s = scene, &b = boundaries](const Lane& lane) {
            return score(s, found(lane), kLatency_ms, std::nullopt, &b);
        };
        const SceneScore whole = scored_here(*scene.ground_truth);
        EXPECT_EQ(whole.category, Category::ground_truth);
        EXPECT_EQ(whole.iou, 1.0);
        EXPECT_TRUE(whole.accurate());

        Lane open = *scene.ground_truth;
        open.closed = false;
        const SceneScore without_last_stretch = scored_here(open);
        EXPECT_EQ(without_last_stretch.category, Category::near_ground_truth);
        EXPECT_NEAR(without_last_stretch.iou.value(), 23.0 / 24.0, 1e-6);

        Lane swapped = *scene.ground_truth;
        std::swap(swapped.left, swapped.right);
        EXPECT_EQ(scored_here(swapped).iou, 0.0);
        EXPECT_EQ(scored_here(swapped).category, Category::diverging_below_20);
    }
}

TEST(Score, FailuresScoreNothing) {
    const AnnotatedScene scene = straight_scene();
    for (const LaneStatus status : {LaneStatus::none, LaneStatus::stopped, LaneStatus::error}) {
        SCOPED_TRACE(to_string(status));
        LaneAnswer answer{.status = status};
        answer.optimality = Optimality{.objective = -3.0, .bound = -3.0, .optimal = true};
        const SceneScore result = score(scene, answer, kLatency_ms, std::nullopt, &kTrack);
        EXPECT_EQ(result.category, Category::none);
        EXPECT_FALSE(result.success());
        EXPECT_EQ(result.iou, 0.0);
        EXPECT_TRUE(result.accuracy) << "the scene still counts";
        EXPECT_FALSE(result.accurate());
        EXPECT_EQ(result.solved_to_optimality, false);
        EXPECT_DOUBLE_EQ(result.latency_ms, kLatency_ms);
    }
    EXPECT_EQ(scored(scene, {}).category, Category::none) << "found, but no cone";
}

TEST(Score, SolvedToOptimalityNeedsTimeAndGap) {
    const AnnotatedScene scene = straight_scene();
    const auto solved = [&](double bound, double latency_ms) {
        LaneAnswer answer = found(*scene.ground_truth);
        answer.optimality = Optimality{.objective = 0.0, .bound = bound, .optimal = true};
        return score(scene, answer, latency_ms, std::nullopt, &kTrack).solved_to_optimality;
    };
    EXPECT_EQ(solved(0.0, 400.0), true);
    EXPECT_EQ(solved(0.0, 400.1), false);
    EXPECT_EQ(solved(-1e-5, 3.0), true);
    EXPECT_EQ(solved(-1.1e-5, 3.0), false);
    EXPECT_EQ(solved(-std::numeric_limits<double>::infinity(), 3.0), false);
}

TEST(Score, Enumeration) {
    const AnnotatedScene scene = straight_scene();
    Lane all_but_one = *scene.ground_truth;
    std::erase(all_but_one.left, 5);  // straight on: the same region
    LaneAnswer answer = found(truncated(scene, 7));
    answer.enumeration = Enumeration{.iterations = 90, .complete = true, .candidates = {}};
    const SceneScore without = score(scene, answer, kLatency_ms, std::nullopt, &kTrack);
    ASSERT_TRUE(without.enumeration);
    EXPECT_EQ(without.enumeration->iterations, 90);
    EXPECT_TRUE(without.enumeration->complete);
    EXPECT_FALSE(without.enumeration->best_iou);
    EXPECT_FALSE(without.enumeration->first_near_ground_truth_iteration);

    answer.enumeration->candidates = {{truncated(scene, 4), 3}, {truncated(scene, 7), 20}};
    const SceneScore far = score(scene, answer, kLatency_ms, std::nullopt, &kTrack);
    EXPECT_NEAR(far.enumeration->best_iou.value(), 24.0 / 36.0, 1e-12);
    EXPECT_FALSE(far.enumeration->first_near_ground_truth_iteration);

    answer.enumeration->candidates.push_back({all_but_one, 41});
    answer.enumeration->candidates.push_back({*scene.ground_truth, 57});
    const SceneScore near = score(scene, answer, kLatency_ms, std::nullopt, &kTrack);
    EXPECT_EQ(near.enumeration->best_iou, 1.0);
    EXPECT_EQ(near.enumeration->first_near_ground_truth_iteration, 41);
}

TEST(Score, AConeThatIsNotInTheSceneIsNamed) {
    const auto key_of = [](const AnnotatedScene& scene, const LaneAnswer& answer) -> std::string {
        try {
            (void)score(scene, answer, kLatency_ms, std::nullopt, &kTrack);
        } catch (const InvalidInput& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr("999"));
            EXPECT_THAT(error.what(), testing::HasSubstr("straight"));
            return error.key();
        }
        return "accepted";
    };
    const AnnotatedScene scene = straight_scene();
    EXPECT_EQ(key_of(scene, found({{1, 2}, {101, 102, 999}})), "right[2]");
    LaneAnswer candidate = found(*scene.ground_truth);
    candidate.enumeration = Enumeration{1, true, {{*scene.ground_truth, 1}, {Lane{{999}, {101}}, 2}}};
    EXPECT_EQ(key_of(scene, candidate), "candidates[1].left[0]");
    AnnotatedScene broken = scene;
    broken.ground_truth->left[1] = 999;
    EXPECT_EQ(key_of(broken, found(*scene.ground_truth)), "ground_truth.left[1]");
}

TEST(Score, OnlyScenesWithTwoConesOnEachSideCount) {
    AnnotatedScene scene = straight_scene();
    EXPECT_TRUE(counts(scene));
    scene.ground_truth->right.resize(1);
    EXPECT_FALSE(counts(scene));
    EXPECT_THROW((void)scored(scene, {{1, 2}, {101, 102}}), InvalidInput);
    scene.ground_truth.reset();
    EXPECT_FALSE(counts(scene));
    EXPECT_THROW((void)scored(scene, {{1, 2}, {101, 102}}), InvalidInput);
}

TEST(Score, DegenerateLanesAreScoredAsTheyAre) {
    const AnnotatedScene scene = straight_scene();
    for (const Lane& lane : std::vector<Lane>{{{1}, {101}},
                                              {{1, 2, 3}, {}},
                                              {{}, {101}},
                                              {{1, 1, 1}, {101, 101}},
                                              {{1, 2, 1, 2}, {101, 102, 101}},
                                              {{1, 2}, {1, 2}},
                                              {{1}, {1}, true}}) {
        const SceneScore result = scored(scene, lane);
        EXPECT_LT(result.iou.value(), 0.2);
        EXPECT_FALSE(result.accurate());
    }
    Lane repeated = *scene.ground_truth;
    repeated.left.insert(repeated.left.begin(), 1);
    const SceneScore result = scored(scene, repeated);
    EXPECT_EQ(result.iou, 1.0);
    EXPECT_EQ(result.category, Category::near_ground_truth);
    EXPECT_TRUE(result.accurate());
}

TEST(Summary, KeepsFailuresInEveryMean) {
    const AnnotatedScene scene = straight_scene();
    std::vector<SceneScore> scores;
    LaneAnswer right = found(*scene.ground_truth);
    right.optimality = Optimality{-1.0, -1.0, true};
    right.enumeration = Enumeration{10, true, {{*scene.ground_truth, 4}}};
    scores.push_back(score(scene, right, 10.0, std::nullopt, &kTrack));
    LaneAnswer shortened = found(truncated(scene, 7));
    shortened.optimality = Optimality{-1.0, -2.0, false};
    shortened.enumeration = Enumeration{2500, false, {{truncated(scene, 7), 9}}};
    scores.push_back(score(scene, shortened, 20.0, std::nullopt, &kTrack));
    scores.push_back(score(scene, LaneAnswer{}, 60.0, std::nullopt, &kTrack));
    scores.push_back(score(scene, right, 30.0, 3, nullptr));  // accuracy does not count

    const ScoreSummary summary = summarise(scores);
    EXPECT_EQ(summary.scenes, 4u);
    EXPECT_EQ(summary.divergence_unknown, 1u);
    EXPECT_THAT(summary.category_share, testing::ElementsAre(0.25, 0.5, 0.0, 0.0, 0.25, 0.0));
    EXPECT_DOUBLE_EQ(summary.share(Category::too_short), 0.25);
    EXPECT_DOUBLE_EQ(summary.success_share, 0.75);
    EXPECT_DOUBLE_EQ(summary.usable_share.value(), 2.0 / 3.0) << "of the last scene it is unknown";
    EXPECT_NEAR(summary.mean_iou.value(), (1.0 + 2.0 / 3.0 + 0.0 + 1.0) / 4.0, 1e-12);
    EXPECT_EQ(summary.accuracy_scenes, 3u);
    EXPECT_DOUBLE_EQ(summary.accurate_share.value(), 1.0 / 3.0);
    EXPECT_DOUBLE_EQ(summary.solved_share.value(), 0.5);
    EXPECT_DOUBLE_EQ(summary.complete_share.value(), 0.5);
    EXPECT_NEAR(summary.best_candidate_mean_iou.value(), (1.0 + 2.0 / 3.0 + 0.0 + 1.0) / 4.0, 1e-12);
    EXPECT_DOUBLE_EQ(summary.best_candidate_near_share.value(), 0.5);
    EXPECT_DOUBLE_EQ(summary.latency.median_ms, 25.0);
    EXPECT_DOUBLE_EQ(summary.latency.share_within_budget, 0.75);
}

/// Twenty scenes with 5 points of the centre line each. The offset grows by 1 cm from point to point, and the
/// heading error by 1 mrad from scene to scene.
TEST(Summary, OfCentreLinesIsOverAllTheirPoints) {
    std::vector<SceneScore> scores(20);
    for (int i = 0; i < 20; ++i) {
        CentreLineError error;
        for (int k = 1; k <= 5; ++k) error.lateral_m.push_back(0.01F * static_cast<float>(5 * i + k));
        error.heading_rad = 0.001 * (i + 1);
        scores[i].centre_line_error = error;
        if (i > 0) scores[i].steady = i % 4 != 0;  // not at 4, 8, 12 and 16
    }
    const ScoreSummary summary = summarise(scores);
    EXPECT_NEAR(summary.lateral_median_m.value(), 0.505, 1e-6);
    EXPECT_NEAR(summary.lateral_p95_m.value(), 0.95, 1e-6);
    EXPECT_NEAR(summary.heading_median_rad.value(), 0.0105, 1e-9);
    EXPECT_NEAR(summary.heading_p95_rad.value(), 0.019, 1e-9);
    EXPECT_NEAR(summary.unsteady_share.value(), 4.0 / 19.0, 1e-12);
}

TEST(Summary, LeavesOutMeasuresThatNoDetectorStates) {
    const AnnotatedScene scene = straight_scene();
    const std::vector<SceneScore> scores{score(scene, found(*scene.ground_truth), 1.0, 3, &kTrack)};
    const ScoreSummary summary = summarise(scores);
    EXPECT_FALSE(summary.accurate_share);
    EXPECT_FALSE(summary.solved_share);
    EXPECT_FALSE(summary.complete_share);
    EXPECT_FALSE(summary.best_candidate_mean_iou);
    EXPECT_FALSE(summary.best_candidate_near_share);
    EXPECT_THROW((void)summarise({}), InvalidInput);
}

}  // namespace
}  // namespace conelane
