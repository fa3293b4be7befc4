// The study of scenes made of false cones alone.

#include "experiments/studies/noise.hpp"

#include "conelane/invalid_input.hpp"
#include "tests/support/testing.hpp"

namespace conelane::experiments {
namespace {

TEST(Noise, ScenesAreDrawnInTheHalfDiscBySeedRangeAndNumber) {
    NoiseOptions options;
    std::set<double> drawn;
    for (std::size_t index = 0; index < 50; ++index) {
        const Scene scene = noise_scene(options, 30.0, index);
        ASSERT_EQ(scene.cones.size(), 16U);
        EXPECT_NO_THROW(validate(scene));
        for (const Cone& cone : scene.cones) {
            EXPECT_GE(cone.position.x(), 0.0);
            EXPECT_LE(cone.position.norm(), 30.0);
            EXPECT_TRUE(drawn.insert(cone.position.x()).second);
        }
        EXPECT_EQ(noise_scene(options, 30.0, index).cones[7].position, scene.cones[7].position);
    }
    const Point usual = noise_scene(options, 30.0, 3).cones[0].position;
    options.seed = 2;
    EXPECT_NE(noise_scene(options, 30.0, 3).cones[0].position, usual);
}

/// Of 16 false cones and no course, a lane may be claimed in 5 % of the scenes.
TEST(Noise, FrontSeldomClaimsALane) {
    NoiseOptions options;
    options.scenes = 200;
    options.ranges_m = {30.0, 50.0};
    for (const NoiseRow& row : noise_rows(options)) {
        SCOPED_TRACE(row.detector);
        EXPECT_EQ(row.scenes, 200U);
        EXPECT_LE(row.claimed + row.unrated, row.found);
        EXPECT_LE(row.claimed, 10U);
        EXPECT_LE(row.trusted_10_m, 2U);
    }
}

TEST(Noise, CountsLanesWithoutAConfidenceApart) {
    NoiseOptions options;
    options.detectors = {"nearest"};
    EXPECT_THROW((void)noise_rows(options), InvalidInput);
    options.detectors = {"delaunay-beam", "clc"};
    options.cones = 40;
    options.ranges_m = {20.0};
    options.scenes = 40;
    std::size_t found = 0;
    for (const NoiseRow& row : noise_rows(options)) {
        found += row.found;
        EXPECT_EQ(row.unrated, row.found);
        EXPECT_EQ(row.claimed, 0U);
        EXPECT_EQ(row.max_confidence, 0.0);
    }
    EXPECT_GT(found, 0U);
    options.ranges_m = {0.0};
    EXPECT_THROW((void)noise_rows(options), InvalidInput);
}

}  // namespace
}  // namespace conelane::experiments
