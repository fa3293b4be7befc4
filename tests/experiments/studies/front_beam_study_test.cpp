// What wider beams of `front` find, on a generated course.

#include "conelane/invalid_input.hpp"
#include "experiments/studies/front_beam.hpp"
#include "graph_search/front/front_detector.hpp"
#include "tests/support/testing.hpp"

namespace conelane::experiments {
namespace {

SceneSet kidney(double rate) {
    SceneOptions options;
    options.false_positive_rates = {rate};
    options.ranges_m = {30.0};
    options.every_m = 12.0;
    return make_scene_set({"generated:kidney@3"}, options);
}

FrontBeamOptions widths(std::vector<std::size_t> beams) {
    FrontBeamOptions options;
    options.weights = shipped_front_options().weights;
    options.beams = std::move(beams);
    options.reference_beam = 200;
    return options;
}

TEST(FrontBeam, AWiderBeamMeetsTheBestLaneAtLeastAsOften) {
    const SceneSet set = kidney(0.4);
    const auto rows = front_beam_rows(set, widths({1, 15}));
    ASSERT_THAT(rows, testing::SizeIs(3));
    // No row has to find all lanes: states with the same front are merged although their lanes differ.
    EXPECT_GE(rows[0].best_score + rows[1].best_score + rows[2].best_score, 1.0);
    EXPECT_LT(rows[0].best_score, rows[1].best_score);
    EXPECT_LE(rows[1].best_score, rows[2].best_score);
    EXPECT_EQ(rows[2].beam, 200U);
    for (const FrontBeamRow& row : rows) {
        EXPECT_EQ(row.scenes, set.scenes.size());
        EXPECT_LE(row.usable, row.any_usable);
        EXPECT_LE(row.first_usable, row.any_usable);
        EXPECT_GT(row.median_ms, 0.0);
        EXPECT_LE(row.median_ms, row.worst_ms);
    }
    EXPECT_GT(rows[1].usable, 0.8);
    EXPECT_GT(rows[1].iou, 0.8);
}

// Eight cones have few lanes, so a complete search ends; within a millionth of a second, no search ends.
TEST(FrontBeam, AProofTakesASearchThatLeavesNothingOut) {
    SceneOptions options;
    options.false_positive_rates = {0.0};
    options.ranges_m = {30.0};
    options.every_m = 40.0;
    options.nearest = 8;
    const SceneSet set = make_scene_set({"generated:kidney@3"}, options);
    FrontBeamOptions both = widths({1});
    both.exhaustive_ms = {1e-6, 1e6};
    const auto rows = front_beam_rows(set, both);
    ASSERT_THAT(rows, testing::SizeIs(4));
    EXPECT_LT(rows[0].proven, 1.0);
    EXPECT_EQ(rows[2].proven, 0.0);
    EXPECT_EQ(rows[3].proven, 1.0);
    EXPECT_EQ(rows[3].best_score, 1.0);
    EXPECT_EQ(rows[3].beam, 0U);
}

TEST(FrontBeam, AskedForNothingItSaysSo) {
    EXPECT_THROW((void)front_beam_rows({}, widths({15})), InvalidInput);
    EXPECT_THROW((void)front_beam_rows(kidney(0.0), widths({0})), InvalidInput);
}

}  // namespace
}  // namespace conelane::experiments
