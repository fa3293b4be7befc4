// Answers of `front` to scenes that show only one boundary.

#include "graph_search/front/front_boundary.hpp"

#include "conelane/detectors.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/world/generated_tracks.hpp"
#include "evaluation/world/scene_generation.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/processor_time.hpp"
#include "tests/support/recorded_tracks.hpp"

namespace conelane::experiments {
namespace {

using tests::cones_at;

LaneAnswer front(const Scene& scene) {
    return make_detector("front")->detect(scene, tests::kNoTimeLimit);
}

/// The boundary of the answer; nothing if the other side is not empty or there is no answer.
struct Boundary {
    Side side;
    std::vector<ConeId> cones;
};
std::optional<Boundary> boundary_of(const LaneAnswer& answer) {
    if (answer.lane.left.empty() == answer.lane.right.empty()) return std::nullopt;
    if (answer.lane.right.empty()) return Boundary{kLeft, answer.lane.left};
    return Boundary{kRight, answer.lane.right};
}

/// The boundary that BoundarySearch finds, whether there is a lane or not.
std::optional<Boundary> search(const Scene& scene) {
    FrontMap map;
    map.build(scene);
    BoundarySearch search;
    SearchBudget unlimited;
    std::vector<Vertex> cones;
    const std::optional<Side> side = search.find(map, unlimited, cones);
    if (!side) return std::nullopt;
    Boundary boundary{*side, {}};
    for (const Vertex cone : cones) boundary.cones.push_back(scene.cones[map.scene_index(cone)].id);
    return boundary;
}

void expect_boundary(const Scene& scene, Side side) {
    const std::optional<Boundary> boundary = search(scene);
    ASSERT_TRUE(boundary);
    EXPECT_EQ(boundary->side, side);
    EXPECT_EQ(boundary->cones.size(), scene.cones.size());
    EXPECT_TRUE(std::ranges::is_sorted(boundary->cones)) << "outward from the car";
}

/// The cones of a boundary 1.75 m beside a bend that a car at the origin drives; cones begin at `from_m`.
std::vector<Point> arc(double radius_m, double turn, Side side, double from_m = 1.5) {
    const double radius = radius_m + ((side == kLeft) == (turn > 0.0) ? -1.75 : 1.75);
    std::vector<Point> cones;
    for (double angle = from_m / radius; angle < std::min(2.4, 30.0 / radius_m); angle += 3.0 / radius)
        cones.emplace_back(radius * std::sin(angle), turn * (radius_m - radius * std::cos(angle)));
    return cones;
}

TEST(FrontBoundary, IsAnsweredOnTheSideOnWhichItPassesTheCar) {
    for (const Side side : {kLeft, kRight}) {
        for (const double turn : {1.0, -1.0}) {
            for (const double radius_m : {8.0, 11.0, 15.0, 40.0, 1e4}) {
                SCOPED_TRACE(testing::Message() << "side " << side << " turn " << turn << " r " << radius_m);
                expect_boundary(cones_at(arc(radius_m, turn, side)), side);
            }
        }
    }
}

// In a bend to the left, the right boundary crosses to the left of the heading. If only that part is seen,
// its curvature tells which side it is.
TEST(FrontBoundary, TheOuterBoundaryOfABendMayBeginAcrossTheHeading) {
    for (const double turn : {1.0, -1.0}) {
        const std::vector<Point> outer = arc(12.0, turn, turn > 0.0 ? kRight : kLeft, 9.0);
        ASSERT_GT(turn * outer.front().y(), 0.5);
        expect_boundary(cones_at(outer), turn > 0.0 ? kRight : kLeft);
    }
}

TEST(FrontBoundary, BridgesAMissedConeFromTheThirdOn) {
    std::vector<Point> cones;
    for (const double x : {1.0, 5.0, 9.0, 17.0, 21.0, 25.0}) cones.emplace_back(x, -1.8);
    expect_boundary(cones_at(cones), kRight);
}

/// A segment of a lane may be longer if cones are few, because the other boundary shows the way.
TEST(FrontBoundary, EndsBeforeALongGap) {
    const auto found = [](double gap_m) {
        std::vector<Point> cones;
        for (const double x : {1.0, 5.0, 9.0, 9.0 + gap_m, 13.0 + gap_m, 17.0 + gap_m})
            cones.emplace_back(x, -1.8);
        return search(cones_at(cones)).value().cones;
    };
    EXPECT_EQ(found(11.4), (std::vector<ConeId>{0, 1, 2, 3, 4, 5}));
    EXPECT_EQ(found(11.6), (std::vector<ConeId>{0, 1, 2}));
}

/// The cone at 11.3 m is too near the one before it to be the next one, and it blocks the bridge.
TEST(FrontBoundary, BridgesNothingOverACone) {
    std::vector<Point> cones;
    for (const double x : {1.0, 5.4, 9.8, 17.8, 22.2, 26.6}) cones.emplace_back(x, -1.8);
    expect_boundary(cones_at(cones), kRight);
    cones.emplace_back(11.3, -1.8);
    EXPECT_EQ(search(cones_at(cones)).value().cones, (std::vector<ConeId>{0, 1, 2}));
}

/// Along y = 1.8, once round a circle to the left, and down across the beginning, between cones 2 and 3.
TEST(FrontBoundary, EndsBeforeItCrossesItself) {
    std::vector<Point> cones;
    for (const double x : {1.0, 4.0, 7.0, 10.0, 13.0}) cones.emplace_back(x, 1.8);
    for (int i = 1; i <= 7; ++i)
        cones.emplace_back(13.0 + 4.7 * std::sin(0.66 * i), 6.5 - 4.7 * std::cos(0.66 * i));
    const auto last = static_cast<ConeId>(cones.size()) - 1;
    for (const double y : {3.3, 0.2, -2.8, -5.8, -8.8}) cones.emplace_back(8.4, y);
    const std::vector<ConeId> boundary = search(cones_at(cones)).value().cones;
    EXPECT_EQ(boundary.back(), last + 1);
}

TEST(FrontBoundary, LeavesOutConesBesideIt) {
    std::vector<Point> cones;
    for (int i = 0; i < 7; ++i) cones.emplace_back(1.0 + 4.0 * i, 1.8);
    cones.emplace_back(13.5, 12.0);
    cones.emplace_back(20.0, 15.0);
    const std::optional<Boundary> boundary = boundary_of(front(cones_at(cones)));
    ASSERT_TRUE(boundary);
    EXPECT_EQ(boundary->side, kLeft);
    EXPECT_EQ(boundary->cones, (std::vector<ConeId>{0, 1, 2, 3, 4, 5, 6}));
}

TEST(FrontBoundary, OnlySmoothChainsBesideTheCarAreBoundaries) {
    for (const std::vector<Point>& cones : std::vector<std::vector<Point>>{
             {{1, 1.8}, {5, 1.8}},                       // only two
             {{1, 1.8}, {2, 1.8}, {7.5, 1.8}},           // uneven spacing
             {{1, 1.8}, {4, 4.0}, {7, 1.8}},             // corner
             {{1, 0.0}, {5, 0.0}, {9, 0.0}, {13, 0.0}},  // straight ahead of the car: on neither side
             {{1, 5.8}, {5, 5.8}, {9, 5.8}, {13, 5.8}},  // farther away than any lane is wide
             {{14, 1.8}, {18, 1.8}, {22, 1.8}},          // far ahead
             {{1, 1.8}, {8, 1.8}, {15, 1.8}}}) {         // too far apart
        const LaneAnswer answer = front(cones_at(cones));
        EXPECT_EQ(answer.status, LaneStatus::none) << testing::PrintToString(cones);
        EXPECT_EQ(answer.lane, Lane{});
    }
}

TEST(FrontBoundary, NeitherOrderNorIdsOfTheConesMatter) {
    Scene scene = cones_at(arc(9.0, 1.0, kRight));
    std::vector<ConeId> cones = search(scene).value().cones;
    std::ranges::reverse(scene.cones);
    EXPECT_EQ(search(scene).value().cones, cones);
    const auto last = static_cast<ConeId>(scene.cones.size()) - 1;
    for (Cone& cone : scene.cones) cone.id = last - cone.id;
    for (ConeId& id : cones) id = last - id;
    EXPECT_EQ(search(scene).value().cones, cones);
}

TEST(FrontBoundary, AMirroredSceneHasTheMirroredBoundary) {
    Scene scene = cones_at(arc(9.0, -1.0, kLeft));
    const std::vector<ConeId> cones = search(scene).value().cones;
    for (Cone& cone : scene.cones) cone.position.y() *= -1.0;
    EXPECT_EQ(search(scene).value().side, kRight);
    EXPECT_EQ(search(scene).value().cones, cones);
}

TEST(FrontBoundary, IsRarelyMadeOfNoise) {
    boost::random::mt19937_64 random(5);
    boost::random::uniform_real_distribution<double> ahead_m(0.0, 30.0);
    boost::random::uniform_real_distribution<double> left_m(-30.0, 30.0);
    const auto detector = make_detector("front");
    constexpr int kScenes = 1000;
    for (const int cones : {8, 16, 24}) {
        int without_lane = 0;
        int boundaries = 0;
        for (int i = 0; i < kScenes; ++i) {
            std::vector<Point> points;
            while (points.size() < static_cast<std::size_t>(cones)) {
                const double x = ahead_m(random);
                const Point point(x, left_m(random));
                if (point.norm() < 30.0) points.push_back(point);
            }
            const LaneAnswer answer = detector->detect(cones_at(points), tests::kNoTimeLimit);
            if (!answer.lane.left.empty() && !answer.lane.right.empty()) continue;
            ++without_lane;
            if (answer.status == LaneStatus::found) ++boundaries;
        }
        EXPECT_GT(without_lane, 100) << cones;
        EXPECT_LE(boundaries, kScenes / 25) << cones;
    }
}

// Thousands of cones on one side: no lane can start, and there are many chains.
TEST(FrontBoundary, KeepsTheDeadlineInACrowd) {
    boost::random::mt19937_64 random(5);
    boost::random::uniform_real_distribution<double> ahead_m(0.0, 40.0);
    boost::random::uniform_real_distribution<double> left_m(2.6, 9.0);
    std::vector<Point> points;
    for (int i = 0; i < 4000; ++i) {
        const double x = ahead_m(random);
        points.emplace_back(x, left_m(random));
    }
    const Scene scene = cones_at(points);
    const auto detector = make_detector("front");
    for (const double limit_ms : {5.0, 50.0}) {
        LaneAnswer answer;
        EXPECT_LT(tests::overrun_ms(limit_ms, 100.0,
                                    [&] { answer = detector->detect(scene, {.time_limit_ms = limit_ms}); }),
                  100.0);
        EXPECT_NE(answer.status, LaneStatus::error);
    }
}

/// Whether the true lane is to the right of its left boundary and to the left of its right one.
bool is_in_lane(const Point& point, const LaneOutline& truth) {
    const auto left_of = [&](const std::vector<Point>& boundary) {
        const PolylineFoot foot = foot_on_polyline(point, boundary, truth.closed);
        const Point& from = boundary[foot.segment];
        return cross(boundary[(foot.segment + 1) % boundary.size()] - from, point - from) > 0.0;
    };
    return !left_of(truth.left) && left_of(truth.right);
}

/// Views of courses with one boundary hidden.
struct Views {
    std::size_t all = 0;
    std::size_t answered = 0;  ///< with the other boundary
    std::size_t driven = 0;    ///< of these, views whose lane stays between the boundaries for 10 m
};

Views views_of_one_boundary(const std::vector<Track>& tracks, double every_m) {
    SceneOptions options{.false_positive_rates = {0.0}, .ranges_m = {30.0}, .every_m = every_m};
    const auto detector = make_detector("front");
    Views views;
    for (const Track& track : tracks) {
        for (const AnnotatedScene& seen : generate_scenes(track, options)) {
            const LaneOutline truth = outline_of(*seen.ground_truth, seen.scene);
            for (const std::vector<std::size_t>* hidden : {&track.left, &track.right}) {
                Scene scene = seen.scene;
                std::erase_if(scene.cones, [&](const Cone& cone) {
                    return std::ranges::any_of(*hidden, [&](std::size_t index) {
                        return (track.cones[index].position - cone.position).norm() < 0.5;
                    });
                });
                const LaneAnswer answer = detector->detect(scene, tests::kNoTimeLimit);
                ++views.all;
                if (!boundary_of(answer)) continue;
                ++views.answered;
                const DrivableLane lane = drivable(answer, scene);
                if (lane.length_m >= 10.0 &&
                    std::ranges::all_of(lane.points, [&](const DrivablePoint& point) {
                        return point.s_m > 10.0 || is_in_lane(point.position, truth);
                    })) {
                    ++views.driven;
                }
            }
        }
    }
    return views;
}

// Other parts of the course always show cones opposite to the seen boundary; a lane of both is rarely likely.
TEST(FrontBoundary, IsAnsweredInMostViewsThatShowNoOther) {
    const Views views =
        views_of_one_boundary({generate_track("kidney", 3), generate_track("infield", 3)}, 8.0);
    EXPECT_GT(views.all, 100U);
    EXPECT_GE(2 * views.answered, views.all);
}

TEST(FrontBoundary, CanBeDrivenByOnRecordedCourses) {
    CONELANE_RECORDED_TRACKS_OR_SKIP(tracks);
    const Views views = views_of_one_boundary(tracks, 15.0);
    RecordProperty("driven", std::to_string(views.driven) + " of " + std::to_string(views.answered) +
                                 " answered of " + std::to_string(views.all));
    EXPECT_GE(2 * views.answered, views.all);
    EXPECT_GE(100 * views.driven, 95 * views.answered);
}

}  // namespace
}  // namespace conelane::experiments
