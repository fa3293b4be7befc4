#include "graph_search/baselines/astar_lane/astar_lane_detector.hpp"
#include "graph_search/shared/search_graph.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/refusal.hpp"

namespace conelane {
namespace {

LaneAnswer detect(const Scene& scene, const AstarLaneParameters& parameters = {}) {
    return make_astar_lane_detector(parameters)->detect(scene, tests::kNoTimeLimit);
}

/// Left cones 0, 1, ..., right ones 100, 101, ... of a bend of this radius to the left, 3.6 m wide, every 3 m
/// along its centre line; the car is on that line, 1 m before the first cones.
Scene bend(double radius_m, int cones_a_side) {
    Scene scene;
    for (int i = 0; i < cones_a_side; ++i) {
        const double angle_rad = (1.0 + 3.0 * i) / radius_m;
        const auto at = [&](double from_centre_m) {
            return Point(from_centre_m * std::sin(angle_rad), radius_m - from_centre_m * std::cos(angle_rad));
        };
        scene.cones.push_back({i, at(radius_m - 1.8)});
        scene.cones.push_back({100 + i, at(radius_m + 1.8)});
    }
    return scene;
}

const Lane kSixGates{{0, 1, 2, 3, 4, 5}, {100, 101, 102, 103, 104, 105}};

TEST(AstarLane, FollowsABend) {
    for (const double radius_m : {8.0, 15.0, 1000.0}) {
        SCOPED_TRACE(radius_m);
        const LaneAnswer answer = detect(bend(radius_m, 6));
        EXPECT_EQ(answer.status, LaneStatus::found);
        EXPECT_EQ(answer.lane, kSixGates);
    }
}

TEST(AstarLane, DoesNotTurnTighterThanTheCarCan) {
    AstarLaneParameters parameters{.least_radius_m = 8.0};
    EXPECT_NE(detect(bend(5.0, 6), parameters).lane, kSixGates);
    parameters.least_radius_m = 4.0;
    EXPECT_EQ(detect(bend(5.0, 6), parameters).lane, kSixGates);
}

TEST(AstarLane, ReadsConesBesideTheLaneOut) {
    Scene scene = bend(1000.0, 6);
    scene.cones.push_back({20, {8.5, 3.6}});
    scene.cones.push_back({21, {13.0, -5.0}});
    EXPECT_EQ(detect(scene).lane, kSixGates);
}

TEST(AstarLane, DrivesRoundAConeInItsWay) {
    Scene scene = bend(1000.0, 6);
    scene.cones.push_back({20, {7.0, 0.0}});
    const LaneAnswer answer = detect(scene);
    ASSERT_EQ(answer.status, LaneStatus::found);
    EXPECT_GE(answer.lane.left.size() + answer.lane.right.size(), 10u);
}

TEST(AstarLane, EndsWhereTheConesEnd) {
    AstarLaneParameters parameters{.horizon_m = 60.0};
    Scene scene = bend(1000.0, 4);
    // Two more on the left, far behind the last of the right.
    scene.cones.push_back({30, {30.0, 1.8}});
    scene.cones.push_back({31, {33.0, 1.8}});
    const LaneAnswer answer = detect(scene, parameters);
    EXPECT_EQ(answer.lane, (Lane{{0, 1, 2, 3}, {100, 101, 102, 103}}));
}

TEST(AstarLane, SaysThatItsLimitEndedTheSearch) {
    AstarLaneParameters parameters{.max_steps = 3};
    Scene scene = bend(15.0, 6);
    const LaneAnswer answer = detect(scene, parameters);
    EXPECT_EQ(answer.status, LaneStatus::stopped);
    EXPECT_EQ(answer.stopped_by, StopReason::iterations);
}

TEST(AstarLane, KeepsNothingOfTheSceneBefore) {
    const auto detector = make_astar_lane_detector({});
    ASSERT_EQ(detector->detect(bend(15.0, 6), tests::kNoTimeLimit).status, LaneStatus::found);
    const LaneAnswer stopped = detector->detect(bend(15.0, 2), {.time_limit_ms = 0.0});
    EXPECT_EQ(stopped.status, LaneStatus::stopped);
    EXPECT_EQ(stopped.lane, Lane{});
    EXPECT_EQ(detector->detect(Scene{}, tests::kNoTimeLimit).status, LaneStatus::none);
}

TEST(AstarLane, RefusesParametersOutOfTheirRange) {
    AstarLaneParameters parameters{.least_radius_m = 0.0};
    EXPECT_EQ(refused_key([&] { (void)make_astar_lane_detector(parameters); }), "least_radius_m");
    parameters = {};
    parameters.max_steps = 0;
    EXPECT_THROW((void)make_astar_lane_detector(parameters), InvalidInput);
}

std::vector<PathSample> straight_path(double length_m) {
    std::vector<PathSample> path;
    for (double x_m = 0.0; x_m <= length_m; x_m += 0.25) path.push_back({{x_m, 0.0}, {1.0, 0.0}, x_m});
    return path;
}

TEST(BoundariesAlong, TakeTheChainThatRunsMostEvenly) {
    // Point 3 stands 1.5 m inside of its neighbours' line, 4 is too far, 5 before and 6 beyond the path.
    const std::vector<Point> points{{1, 2}, {4, 2}, {7, 2.2}, {5.5, 0.5}, {6, 6}, {-1, 2}, {11, 2}, {2, -1}};
    SearchBudget budget;
    const PathBoundaries read = boundaries_along(straight_path(10.0), points, {0.4, 4.0, 4.0}, budget);
    EXPECT_EQ(read[kLeft], (std::vector<std::uint32_t>{0, 1, 2}));
    EXPECT_EQ(read[kRight], (std::vector<std::uint32_t>{7}));
    // Without a cost of slopes, every cone is taken.
    EXPECT_EQ(boundaries_along(straight_path(10.0), points, {0.4, 4.0, 0.0}, budget)[kLeft],
              (std::vector<std::uint32_t>{0, 1, 3, 2}));
}

TEST(NearCones, VisitAllWithinTheRadius) {
    boost::random::mt19937_64 random(5);
    const boost::random::uniform_real_distribution<> coordinate(-20.0, 20.0);
    std::vector<Point> points;
    for (int i = 0; i < 300; ++i) {
        const double x_m = coordinate(random);
        points.emplace_back(x_m, coordinate(random));
    }
    points.emplace_back(20.0, 20.0);
    points.emplace_back(-20.0, -20.0);
    NearCones near;
    near.build(points, 20.0, 3.0);
    for (const Point& place : points) {
        std::set<std::pair<double, double>> visited;
        near.visit_near(place, [&](const Point& point) { visited.emplace(point.x(), point.y()); });
        for (const Point& point : points) {
            if ((point - place).norm() <= 3.0) {
                EXPECT_TRUE(visited.contains({point.x(), point.y()}));
            }
        }
    }
}

}  // namespace
}  // namespace conelane
