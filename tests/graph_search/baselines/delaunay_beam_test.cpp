#include "graph_search/baselines/delaunay_beam/delaunay_beam_detector.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/refusal.hpp"

namespace conelane {
namespace {

LaneAnswer detect(const Scene& scene, const DelaunayBeamParameters& parameters = {}) {
    return make_delaunay_beam_detector(parameters)->detect(scene, tests::kNoTimeLimit);
}

/// Left cones 0 to 4, right ones 10 to 14, every 4 m; the car stands 1 m before them.
Scene five_gates() {
    Scene scene;
    for (int i = 0; i < 5; ++i) {
        scene.cones.push_back({i, {1.0 + 4.0 * i, 1.8}});
        scene.cones.push_back({10 + i, {1.5 + 4.0 * i, -1.8}});
    }
    return scene;
}

const Lane kAllGates{{0, 1, 2, 3, 4}, {10, 11, 12, 13, 14}};

TEST(DelaunayBeam, CrossesTheEdgesOfALane) {
    const LaneAnswer answer = detect(five_gates());
    EXPECT_EQ(answer.status, LaneStatus::found);
    EXPECT_EQ(answer.lane, kAllGates);
}

TEST(DelaunayBeam, LeavesConesBesideTheLaneOut) {
    Scene scene = five_gates();
    scene.cones.push_back({20, {8.0, 5.5}});
    scene.cones.push_back({21, {14.0, -6.0}});
    EXPECT_EQ(detect(scene).lane, kAllGates);
}

// The reason why the CLC paper does not search in a triangulation: beside a cone in the lane, the
// triangulation has no edge from left cone 2 to left cone 3, so one of the boundaries must contain that cone.
TEST(DelaunayBeam, AConeInsideTheLaneIsOnABoundary) {
    Scene scene = five_gates();
    scene.cones.push_back({20, {11.2, 0.2}});
    const Lane lane = detect(scene).lane;
    const auto has = [](const std::vector<ConeId>& side) { return std::ranges::count(side, 20) > 0; };
    EXPECT_TRUE(has(lane.left) || has(lane.right));
}

// Two lanes side by side share the middle row; the colors say which is the car's.
TEST(DelaunayBeam, ColorsTellSidesApart) {
    Scene scene;
    scene.pose.position = {0.0, 1.8};
    for (int i = 0; i < 5; ++i) {
        const double x_m = 1.0 + 4.0 * i;
        scene.cones.push_back({i, {x_m, 3.6}});
        scene.cones.push_back({10 + i, {x_m + 0.5, 0.0}});
        scene.cones.push_back({20 + i, {x_m, -3.6}});
    }
    const auto paint = [&scene](ConeColor left, ConeColor middle, ConeColor right) {
        for (Cone& cone : scene.cones) cone.color = cone.id < 10 ? left : cone.id < 20 ? middle : right;
    };
    EXPECT_EQ(detect(scene).lane.left.front(), 0);
    paint(ConeColor::blue, ConeColor::yellow, ConeColor::yellow);
    EXPECT_EQ(detect(scene).lane.left.front(), 0);
    DelaunayBeamParameters parameters{.w_color = 100.0};
    paint(ConeColor::yellow, ConeColor::blue, ConeColor::yellow);
    EXPECT_EQ(detect(scene, parameters).lane.left.front(), 10) << "the right lane, against the car's place";
}

TEST(DelaunayBeam, GrowsNoFartherThanTheLengthExpected) {
    DelaunayBeamParameters parameters{.expected_length_m = 10.0};
    const Lane lane = detect(five_gates(), parameters).lane;
    EXPECT_GE(lane.left.size(), 3u);
    EXPECT_LT(lane.left.size() + lane.right.size(), 10u);
}

// A narrow beam may miss a lane, and reports that it left paths out; the whole tree contains one.
TEST(DelaunayBeam, FindsNothingButKnowsThatTheBeamWasTooNarrow) {
    DelaunayBeamParameters narrow{.beam_width = 1};
    int missed = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene = tests::random_scene(seed, 9);
        const LaneAnswer answer = detect(scene, narrow);
        if (answer.status == LaneStatus::found) continue;
        if (detect(scene).status != LaneStatus::found) continue;
        EXPECT_EQ(answer.status, LaneStatus::stopped);
        EXPECT_EQ(answer.stopped_by, StopReason::iterations);
        ++missed;
    }
    EXPECT_GT(missed, 0);
}

TEST(DelaunayBeam, RefusesParametersOutOfTheirRange) {
    DelaunayBeamParameters parameters{.w_turn = -1.0};
    EXPECT_EQ(refused_key([&] { (void)make_delaunay_beam_detector(parameters); }), "w_turn");
    parameters = {};
    parameters.beam_width = 0;
    EXPECT_THROW((void)make_delaunay_beam_detector(parameters), InvalidInput);
}

}  // namespace
}  // namespace conelane
