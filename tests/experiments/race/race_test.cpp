// The car, its controller and the world of a race, and whole races with the true centre line.

#include "conelane/invalid_input.hpp"
#include "experiments/race/drivers.hpp"
#include "tests/support/recorded_tracks.hpp"

namespace conelane::experiments {
namespace {

Condition condition_named(const std::string& name) {
    return *std::ranges::find(named_conditions(), name, &Condition::name);
}

RaceOptions options_of(const std::string& condition, std::uint64_t seed = 1) {
    RaceOptions options;
    options.sight.condition = condition_named(condition);
    options.sight.seed = seed;
    return options;
}

const RaceCourse& kidney() {
    static const RaceCourse kCourse = circuit(load_tracks("generated:kidney").front());
    return kCourse;
}

Drive no_path(const Frame& /*frame*/) {
    return {};
}

TEST(Vehicle, DrivesStraightWithoutSteering) {
    Vehicle car{{{1.0, 2.0}, std::numbers::pi / 2.0}};
    for (int i = 0; i < 100; ++i) car.drive(5.0, 0.0, 0.01);
    EXPECT_NEAR(car.pose.position.x(), 1.0, 1e-9);
    EXPECT_NEAR(car.pose.position.y(), 7.0, 1e-9);
    EXPECT_NEAR(car.pose.yaw_rad, std::numbers::pi / 2.0, 1e-12);
}

TEST(Vehicle, DrivesTheCircleOfItsSteeringAngle) {
    const SteeringLimits limits;
    const double radius_m = 10.0;
    const double angle_rad = std::atan(limits.wheelbase_m / radius_m);
    Vehicle car{{{0.0, 0.0}, 0.0}, angle_rad};
    for (int i = 0; i < 2000; ++i) {
        car.drive(5.0, angle_rad, 0.01);
        ASSERT_NEAR((car.pose.position - Point(0.0, radius_m)).norm(), radius_m, 1e-3);
    }
}

TEST(Vehicle, SteersNoFasterAndNoFartherThanItsLimits) {
    const SteeringLimits limits;
    Vehicle car;
    double before_rad = 0.0;
    for (int i = 0; i < 100; ++i) {
        car.drive(5.0, 3.0, 0.01);
        EXPECT_LE(car.steering_rad - before_rad, limits.max_steering_rate_radps * 0.01 + 1e-12);
        before_rad = car.steering_rad;
    }
    EXPECT_DOUBLE_EQ(car.steering_rad, limits.max_steering_rad);
}

TEST(Controller, SteersTowardsThePath) {
    const std::vector<Point> path{{0.0, 1.0}, {20.0, 1.0}};
    double from_m = 0.0;
    EXPECT_GT(pursue({{0.0, 0.0}, 0.0}, path, 3.0, from_m), 0.01);
    from_m = 0.0;
    EXPECT_LT(pursue({{0.0, 2.0}, 0.0}, path, 3.0, from_m), -0.01);
    from_m = 0.0;
    EXPECT_NEAR(pursue({{0.0, 1.0}, 0.0}, path, 3.0, from_m), 0.0, 1e-12);
}

TEST(Controller, FollowsAPathFromItsBeginningWhereItsFarEndIsNearer) {
    // A U-turn to the left whose way back passes the car at 0.5 m.
    const std::vector<Point> path{{0.0, -1.0}, {10.0, -1.0}, {10.0, 0.5}, {-10.0, 0.5}};
    double from_m = 0.0;
    EXPECT_LT(pursue({{0.0, 0.0}, 0.0}, path, 3.0, from_m), 0.0);
    EXPECT_LT(from_m, 3.1);
}

TEST(Controller, HoldsStraightOnWithoutAPath) {
    double from_m = 0.0;
    EXPECT_EQ(pursue({}, std::vector<Point>{{1.0, 1.0}}, 3.0, from_m), 0.0);
}

TEST(MapFrame, GoesToTheMapAndBack) {
    const MapFrame map = MapFrame{0.3, {1.0, -2.0}}.turned(0.5, {4.0, 5.0}, {0.1, 0.2});
    const Point world(7.0, -3.0);
    EXPECT_NEAR((map.to_world(map.to_map(world)) - world).norm(), 0.0, 1e-12);
    // The centre of the rotation is only moved.
    EXPECT_NEAR(
        (map.to_map(Point(4.0, 5.0)) - MapFrame{0.3, {1.0, -2.0}}.to_map(Point(4.0, 5.0)) - Point(0.1, 0.2))
            .norm(),
        0.0, 1e-12);
}

SightOptions sight_of(const std::string& condition, double rate, bool with_ids) {
    SightOptions sight;
    sight.condition = condition_named(condition);
    sight.false_positive_rate = rate;
    sight.with_ids = with_ids;
    sight.seed = 3;
    return sight;
}

TEST(World, FalsePositivesPersistAndAreMissedAndMovedLikeCones) {
    World world(kidney(), sight_of("car", 0.5, true));
    const Pose pose = kidney().line.front();
    std::set<ConeId> ever;
    std::size_t seen = 0;
    constexpr int kFrames = 200;
    for (int i = 0; i < kFrames; ++i) {
        const Frame frame = world.look(pose, {}, 0.1 * i);
        seen += frame.cones.size();
        for (const Cone& cone : frame.cones) ever.insert(cone.id);
    }
    std::size_t in_view = 0;
    const auto is_seen_from_there = [&](const Point& point) {
        return pose.ahead_m(point) >= 0.0 && (point - pose.position).norm() <= 20.0;
    };
    for (const Cone& cone : kidney().cones) in_view += is_seen_from_there(cone.position) ? 1 : 0;
    const std::size_t cones_in_view = in_view;
    for (const Point& point : world.false_positives()) in_view += is_seen_from_there(point) ? 1 : 0;
    EXPECT_GT(in_view, cones_in_view);
    EXPECT_EQ(ever.size(), in_view);
    EXPECT_NEAR(static_cast<double>(seen) / kFrames, 0.95 * static_cast<double>(in_view), 0.5);
}

TEST(World, AboutTheShareAskedForIsFalse) {
    World world(kidney(), sight_of("car", 0.5, true));
    std::set<ConeId> real;
    double share = 0.0;
    std::size_t views = 0;
    for (std::size_t i = 0; i < kidney().line.size(); i += 8) {
        const Frame frame = world.look(kidney().line[i], {}, 0.0);
        std::size_t near_real = 0;
        for (const Cone& cone : frame.cones) {
            near_real += std::ranges::any_of(kidney().cones,
                                             [&](const Cone& true_cone) {
                                                 return (true_cone.position - cone.position).norm() < 0.5;
                                             })
                             ? 1
                             : 0;
        }
        share += 1.0 - static_cast<double>(near_real) / static_cast<double>(frame.cones.size());
        ++views;
    }
    EXPECT_NEAR(share / static_cast<double>(views), 0.5, 0.08);
}

TEST(World, FreshFalsePositivesGetNewIdsFromTheRangeOfTheOthers) {
    World world(kidney(), sight_of("paper", 0.5, true));
    const Pose pose = kidney().line.front();
    const Frame first = world.look(pose, {}, 0.0);
    const Frame second = world.look(pose, {}, 0.1);
    std::set<ConeId> ids;
    for (const Cone& cone : first.cones) ids.insert(cone.id);
    EXPECT_EQ(ids.size(), first.cones.size());
    std::vector<ConeId> kept;
    std::vector<ConeId> fresh;
    for (const Cone& cone : second.cones) (ids.contains(cone.id) ? kept : fresh).push_back(cone.id);
    EXPECT_EQ(kept.size(), fresh.size());  // half of them are false
    // They are not all before or all after the others.
    EXPECT_LT(std::ranges::min(fresh), std::ranges::max(kept));
    EXPECT_LT(std::ranges::min(kept), std::ranges::max(fresh));
}

TEST(World, WithoutIdsNoPointHasOne) {
    for (const char* const condition : {"paper", "car"}) {
        World world(kidney(), sight_of(condition, 0.3, false));
        for (const Cone& cone : world.look(kidney().line.front(), {}, 0.0).cones) {
            EXPECT_EQ(cone.id, kNoId);
        }
    }
}

TEST(World, ChangedIdsAreOthers) {
    World world(kidney(), sight_of("paper", 0.0, true));
    std::set<ConeId> before;
    for (const Cone& cone : world.look(kidney().line.front(), {}, 0.0).cones) before.insert(cone.id);
    world.change_ids();
    for (const Cone& cone : world.look(kidney().line.front(), {}, 0.1).cones) {
        EXPECT_FALSE(before.contains(cone.id));
    }
}

TEST(World, ShowsColorsOnlyWhereAskedFor) {
    SightOptions sight = sight_of("car", 0.3, true);
    World without(kidney(), sight);
    for (const Cone& cone : without.look(kidney().line.front(), {}, 0.0).cones) {
        EXPECT_EQ(cone.color, ConeColor::unknown);
    }
    sight.with_color = true;
    World with(kidney(), sight);
    std::set<ConeColor> colors;
    for (const Cone& cone : with.look(kidney().line.front(), {}, 0.0).cones) colors.insert(cone.color);
    EXPECT_THAT(colors, testing::IsSupersetOf({ConeColor::blue, ConeColor::yellow}));
}

TEST(Race, TheTrueLineDrivesAGeneratedCourseUnderEveryCondition) {
    for (const char* const condition : {"paper", "car", "harsh"}) {
        SCOPED_TRACE(condition);
        const RaceResult result = race(kidney(), options_of(condition), truth_driver(kidney(), 1));
        EXPECT_EQ(to_string(result.end), "finished");
        EXPECT_EQ(result.finished_laps, 1);
        EXPECT_FALSE(result.departure_m);
        EXPECT_EQ(result.frames_without_path, 0);
        EXPECT_EQ(result.wrong_unflagged, 0);
    }
}

TEST(Race, TheTrueLineDrivesAllRecordedCoursesUnderCar) {
    CONELANE_RECORDED_TRACKS_OR_SKIP(tracks);
    for (const Track& track : tracks) {
        if (!track.closed || !track.driven.empty()) continue;
        SCOPED_TRACE(track.name);
        const RaceCourse course = circuit(track);
        const RaceResult result = race(course, options_of("car"), truth_driver(course, 1));
        EXPECT_EQ(to_string(result.end), "finished");
    }
}

TEST(World, AnAngleOfViewHidesWhatIsBesideIt) {
    SightOptions sight = sight_of("paper", 0.5, true);
    sight.fov_rad = std::numbers::pi / 2.0;
    const Pose pose = kidney().line.front();
    const auto is_seen = [&](const Cone& cone) {
        return std::abs(pose.left_m(cone.position)) <= pose.ahead_m(cone.position) + 1e-9 &&
               (cone.position - pose.position).norm() <= 20.0;
    };
    const Frame frame = World(kidney(), sight).look(pose, {}, 0.0);
    EXPECT_TRUE(std::ranges::all_of(frame.cones, is_seen));
    EXPECT_EQ(frame.cones.size(), 2 * std::ranges::count_if(kidney().cones, is_seen)) << "half are false";
    EXPECT_GT(frame.cones.size(), 4U);
}

TEST(Race, WithoutAPathTheCarGoesStraightOnAndDeparts) {
    RaceOptions options = options_of("paper");
    options.keep_replay = true;
    const RaceResult result = race(kidney(), options, no_path);
    EXPECT_EQ(to_string(result.end), "departed");
    EXPECT_EQ(result.frames_without_path, result.frames);
    ASSERT_FALSE(result.replay.empty());
    for (const ReplayFrame& frame : result.replay) {
        EXPECT_NEAR(frame.pose.yaw_rad, kidney().line.front().yaw_rad, 1e-9);
        EXPECT_NEAR(kidney().line.front().left_m(frame.pose.position), 0.0, 1e-6);
    }
}

TEST(Race, ThroughAGapTheCarDepartsToo) {
    // A lane along x, closed by a far way back, whose left boundary has a gap of 30 m: the car turns left in
    // it.
    Track track;
    track.name = "gap";
    const auto add = [&](double x_m, double y_m, std::vector<std::size_t>& side) {
        side.push_back(track.cones.size());
        track.cones.push_back({static_cast<ConeId>(track.cones.size()), {x_m, y_m}});
    };
    for (const double x_m : {0.0, 5.0, 35.0, 60.0}) add(x_m, 2.0, track.left);
    for (const double x_m : {60.0, 0.0}) add(x_m, 40.0, track.left);
    for (const double x_m : {0.0, 20.0, 40.0, 64.0}) add(x_m, -2.0, track.right);
    for (const auto& [x_m, y_m] : {std::pair{64.0, 44.0}, {-4.0, 44.0}, {-4.0, -2.0}}) {
        add(x_m, y_m, track.right);
    }
    const RaceCourse course = circuit(track);
    const Driver left_in_gap = [](const Frame& frame) {
        Drive drive;
        drive.path = frame.pose.position.x() < 12.0
                         ? std::vector<Point>{frame.pose.position, {30.0, 0.0}}
                         : std::vector<Point>{{12.0, 0.0}, {20.0, 3.0}, {25.0, 20.0}};
        return drive;
    };
    const RaceResult result = race(course, options_of("paper"), left_in_gap);
    EXPECT_EQ(to_string(result.end), "departed");
    ASSERT_TRUE(result.departure_m);
    EXPECT_GT(*result.departure_m, 10.0);
    EXPECT_LT(*result.departure_m, 40.0);
    EXPECT_GT(result.wrong_unflagged, 0);
}

TEST(Race, TheControllerKnowsOnlyTheBelievedPose) {
    // The path is a straight line in the map. The map drifts sideways, and the car follows it.
    RaceOptions options = options_of("paper");
    options.drift_m = 40.0;
    const RaceResult drifting = race(kidney(), options, truth_driver(kidney(), 1));
    EXPECT_EQ(to_string(drifting.end), "departed");
}

TEST(Race, TheSameSeedGivesTheSameRaceAndAnotherOneAnother) {
    const auto run = [](std::uint64_t seed) {
        return race(kidney(), options_of("car", seed), truth_driver(kidney(), 1));
    };
    const RaceResult first = run(1);
    const RaceResult again = run(1);
    const RaceResult other = run(2);
    EXPECT_EQ(first.lateral_error_p95_m, again.lateral_error_p95_m);
    EXPECT_EQ(first.driven_m, again.driven_m);
    EXPECT_NE(first.lateral_error_p95_m, other.lateral_error_p95_m);
}

TEST(Race, LapsAreDrivenOneAfterTheOther) {
    RaceOptions options = options_of("paper");
    options.laps = 3;
    const RaceResult result = race(kidney(), options, truth_driver(kidney(), 3));
    EXPECT_EQ(result.finished_laps, 3);
    EXPECT_NEAR(result.driven_m, 3.0 * kidney().length_m, 2.0);
}

/// Two laps by the true line, trusted up to `safe_m`, and the largest speed.
std::pair<RaceResult, double> race_by_safe(double safe_m) {
    RaceOptions options = options_of("paper");
    options.laps = 2;
    options.by_safe = true;
    options.keep_replay = true;
    RaceResult result =
        race(kidney(), options, [&, truth = truth_driver(kidney(), 2, 60.0)](const Frame& frame) {
            Drive drive = truth(frame);
            drive.safe_m = safe_m;
            return drive;
        });
    double fastest_mps = 0.0;
    for (std::size_t i = 1; i < result.replay.size(); ++i) {
        const Point way = result.replay[i].pose.position - result.replay[i - 1].pose.position;
        fastest_mps = std::max(fastest_mps, way.norm() / 0.1);
    }
    return {std::move(result), fastest_mps};
}

TEST(Race, BySafeSpeedTheCarCanStopWhereTheTrustEndsAndLapsAreCountedApart) {
    const auto [far, far_mps] = race_by_safe(1000.0);
    const auto [near, near_mps] = race_by_safe(2.9);
    EXPECT_GT(far_mps, 9.0);
    EXPECT_NEAR(near_mps, std::sqrt(2.0 * 6.0 * 2.9), 1.0);
    EXPECT_NEAR(race_by_safe(0.0).second, 1.5, 0.01) << "it creeps";
    EXPECT_NEAR(far.by_lap[0].time_s + far.by_lap[1].time_s, far.time_s, 0.02);
    EXPECT_LT(far.by_lap[1].time_s, far.by_lap[0].time_s) << "no start from rest";
    for (const std::size_t later : {0U, 1U}) {
        EXPECT_EQ(far.by_lap[later].laps, 1) << later;
        EXPECT_EQ(far.by_lap[later].short_frames + far.by_lap[later].wrong_trusted, 0);
        EXPECT_LT(far.by_lap[later].sideways_p95_m.value(), 0.02);
        EXPECT_EQ(near.by_lap[later].short_frames, near.by_lap[later].frames);
        EXPECT_EQ(near.by_lap[later].right_untrusted, near.by_lap[later].frames);
    }
}

TEST(Race, LatePathsAreOldPaths) {
    RaceOptions options = options_of("paper");
    options.latency_s = 0.25;
    EXPECT_GT(race(kidney(), options, truth_driver(kidney(), 1)).old_path_s, 1.0);
    options.latency_s = 0.05;
    EXPECT_EQ(race(kidney(), options, truth_driver(kidney(), 1)).old_path_s, 0.0);
}

TEST(Race, PathsThatAPlannerCallsOldAreOldPaths) {
    const RaceResult result =
        race(kidney(), options_of("paper"), [truth = truth_driver(kidney(), 1)](const Frame& frame) {
            Drive drive = truth(frame);
            if (frame.time_s > 3.0 && frame.time_s < 4.0) drive.age_s = frame.time_s - 3.0;
            return drive;
        });
    // From the frame at 3.2 s, two frames after the last delivered one, until the next delivery at 4 s.
    EXPECT_NEAR(result.old_path_s, 0.85, 0.011);
}

TEST(Race, AWrongPathCountsUnlessItIsSaidToBeOld) {
    for (const bool is_flagged : {false, true}) {
        const RaceResult result = race(kidney(), options_of("paper"), [&](const Frame& frame) {
            Drive drive;
            drive.path = {frame.pose.position, frame.pose.position + 9.0 * Point(-frame.pose.heading().y(),
                                                                                 frame.pose.heading().x())};
            drive.is_flagged = is_flagged;
            drive.safe_m = is_flagged ? 1.0 : 9.0;
            return drive;
        });
        EXPECT_EQ(result.wrong_unflagged > 0, !is_flagged);
        EXPECT_EQ(result.by_lap[0].wrong_trusted > 0, !is_flagged) << "within its trust";
    }
}

TEST(Race, ACarThatIsToldThatTheWayIsLostBrakes) {
    RaceOptions options = options_of("paper");
    options.with_stop = true;
    const RaceResult result =
        race(kidney(), options, [truth = truth_driver(kidney(), 1)](const Frame& frame) {
            Drive drive = truth(frame);
            drive.brake = frame.time_s > 3.0;
            return drive;
        });
    EXPECT_EQ(to_string(result.end), "halted");
    EXPECT_FALSE(result.departure_m);
}

TEST(Race, ARefusedFrameChangesNothing) {
    const RaceResult result = race(kidney(), options_of("paper"),
                                   [truth = truth_driver(kidney(), 1), i = 0](const Frame& frame) mutable {
                                       Drive drive = truth(frame);
                                       drive.is_refused = ++i % 3 == 0;
                                       return drive;
                                   });
    EXPECT_EQ(to_string(result.end), "finished");
    EXPECT_NEAR(result.frames_refused, result.frames / 3, 1);
    EXPECT_EQ(result.frames_without_path, 0);
}

/// Properties of the frames of a race.
struct Seen {
    std::vector<double> times_s;
    std::vector<std::size_t> cones;
    std::vector<std::set<ConeId>> ids;
    std::vector<Point> positions;
};

Seen frames_of(RaceFault fault) {
    RaceOptions options = options_of("paper");
    options.fault = fault;
    Seen seen;
    const Driver truth = truth_driver(kidney(), 1);
    const RaceResult result = race(kidney(), options, [&](const Frame& frame) {
        seen.times_s.push_back(frame.time_s);
        seen.cones.push_back(frame.cones.size());
        std::set<ConeId> ids;
        for (const Cone& cone : frame.cones) ids.insert(cone.id);
        seen.ids.push_back(ids);
        seen.positions.push_back(frame.pose.position);
        return truth(frame);
    });
    EXPECT_GT(result.time_s, 9.0) << to_string(fault);
    return seen;
}

TEST(RaceFaults, WithoutOneFramesComeEachTenthOfASecond) {
    const Seen seen = frames_of(RaceFault::none);
    for (std::size_t i = 0; i < seen.times_s.size(); ++i) {
        ASSERT_NEAR(seen.times_s[i], 0.1 * static_cast<double>(i), 1e-9);
    }
    EXPECT_GT(std::ranges::min(seen.cones), 0U);
}

TEST(RaceFaults, FramesComeLateOutOfOrderOrTwice) {
    EXPECT_TRUE(std::ranges::is_sorted(frames_of(RaceFault::late).times_s));
    EXPECT_FALSE(std::ranges::is_sorted(frames_of(RaceFault::order).times_s));
    const std::vector<double> twice_s = frames_of(RaceFault::twice).times_s;
    EXPECT_NE(std::ranges::adjacent_find(twice_s), twice_s.end());
}

TEST(RaceFaults, ForASecondNoConeIsSeen) {
    const Seen seen = frames_of(RaceFault::blackout);
    for (std::size_t i = 0; i < seen.cones.size() && i < 160; ++i) {
        EXPECT_EQ(seen.cones[i] == 0, i >= 80 && i < 90) << i;
    }
}

TEST(RaceFaults, IdsChange) {
    const Seen seen = frames_of(RaceFault::ids);
    const auto shared = [&](std::size_t i) {
        std::vector<ConeId> both;
        std::ranges::set_intersection(seen.ids[i], seen.ids[i + 1], std::back_inserter(both));
        return both.size();
    };
    ASSERT_GT(seen.ids.size(), 52U);
    EXPECT_GT(shared(48), 0U);
    EXPECT_EQ(shared(49), 0U);
}

TEST(RaceFaults, TheMapJumps) {
    const Seen seen = frames_of(RaceFault::jump);
    const Seen straight = frames_of(RaceFault::none);
    ASSERT_GT(seen.positions.size(), 52U);
    EXPECT_NEAR((seen.positions[49] - straight.positions[49]).norm(), 0.0, 1e-9);
    EXPECT_NEAR((seen.positions[50] - straight.positions[50]).norm(), 0.5, 1e-9);
}

TEST(RaceFaults, AnUnknownOneIsRefused) {
    EXPECT_THROW(static_cast<void>(race_fault("rain")), InvalidInput);
}

class Missions : public testing::TestWithParam<Mission> {
  protected:
    /// From a standstill, by exact positions.
    [[nodiscard]] RaceResult drive(const Driver& driver) const {
        RaceOptions options = options_of("paper");
        options.with_stop = true;
        return race(course_, options, driver);
    }
    /// By the true line, but for what `change` changes.
    template <typename Change>
    [[nodiscard]] RaceEnd end_of(const Change& change) const {
        return drive([change, truth = truth_driver(course_, 1)](const Frame& frame) mutable {
                   Drive drive = truth(frame);
                   change(drive, frame);
                   return drive;
               })
            .end;
    }

    const RaceCourse course_ = mission_course(GetParam());
};

TEST_P(Missions, TheTrueLineDrivesThemToAStop) {
    RaceOptions options = options_of("car");
    options.with_stop = true;
    options.start_error_m = 3.0;
    options.start_error_rad = 0.35;
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        options.sight.seed = seed;
        const RaceResult result = race(course_, options, truth_driver(course_, 1));
        EXPECT_EQ(to_string(result.end), "finished");
        ASSERT_TRUE(result.stop_said_m);
        EXPECT_GE(*result.stop_said_m, 0.0);
        EXPECT_LT(*result.stop_said_m, 5.0);
        ASSERT_TRUE(result.rest_m);
        EXPECT_LT(*result.rest_m, course_.rest_m);
    }
}

TEST_P(Missions, WhoStopsBeforeTheLineOrNeverHasLost) {
    const RaceEnd early = end_of([](Drive& drive, const Frame& frame) { drive.stop = frame.time_s > 2.0; });
    EXPECT_EQ(to_string(early), "stopped early");
    EXPECT_EQ(to_string(end_of([](Drive& drive, const Frame&) { drive.stop = false; })), "not stopped");
}

TEST_P(Missions, WithoutAPathTheCarDoesNotStart) {
    const RaceResult result = drive(no_path);
    EXPECT_EQ(to_string(result.end), "halted");
    EXPECT_EQ(result.driven_m, 0.0);
}

TEST_P(Missions, APlannerThatTellsOtherPhasesHasLost) {
    if (course_.phases.empty()) GTEST_SKIP() << "a mission without phases";
    const auto told = [&](const std::vector<std::string_view>& phases) {
        std::size_t frames = 0;
        return end_of([&](Drive& drive, const Frame&) {
            drive.state = "following";
            drive.phase = phases[std::min(frames++, phases.size() - 1)];
        });
    };
    EXPECT_EQ(told(course_.phases), RaceEnd::finished);
    std::vector<std::string_view> swapped = course_.phases;
    std::swap(swapped[1], swapped[3]);
    EXPECT_EQ(told(swapped), RaceEnd::wrong_phases);
}

INSTANTIATE_TEST_SUITE_P(All, Missions, testing::Values(Mission::acceleration, Mission::skidpad),
                         [](const auto& tested) { return std::string(to_string(tested.param)); });

TEST(Courses, OfTheRulesHaveTheMeasuresOfTheRules) {
    const RaceCourse skidpad = skidpad_course();
    // Line from 20 m before to 35 m behind, and four rounds.
    EXPECT_NEAR(skidpad.length_m, 55.0 + 8.0 * std::numbers::pi * 9.125, 0.5);
    for (const Cone& cone : skidpad.cones) {
        if (cone.color == ConeColor::orange) continue;
        const double nearest_m =
            std::min((cone.position - Point(0.0, 9.125)).norm(), (cone.position - Point(0.0, -9.125)).norm());
        EXPECT_TRUE(std::abs(nearest_m - 7.625) < 1e-6 || std::abs(nearest_m - 10.625) < 1e-6) << nearest_m;
    }
    // No cone stands in the lane.
    for (const RaceCourse& course : {skidpad, acceleration_course()}) {
        const double end_m = *course.finish_m + course.rest_m - 2.0;
        for (std::size_t i = 0; i < static_cast<std::size_t>(end_m / course.step_m); ++i) {
            for (const Cone& cone : course.cones) {
                EXPECT_GT((cone.position - course.line[i].position).norm(), 1.4);
            }
        }
    }
}

TEST(Courses, BigConesKeepTheirColor) {
    Track track = load_tracks("generated:kidney").front();
    track.cones[track.left[0]].color = ConeColor::big_orange;
    EXPECT_EQ(circuit(track).cones[track.left[0]].color, ConeColor::big_orange);
}

TEST(Courses, AnOpenTrackIsNoCircuit) {
    Track track = load_tracks("generated:kidney").front();
    track.closed = false;
    EXPECT_THROW(static_cast<void>(circuit(track)), InvalidInput);
}

TEST(Drivers, ADetectorDrivesAGeneratedCourseWithAndWithoutIds) {
    for (const bool with_ids : {true, false}) {
        RaceOptions options = options_of("car");
        options.sight.with_ids = with_ids;
        const Racer racer = racers({"front"}, WithPlanner::no).front();
        const RaceResult result = race(kidney(), options, make_driver(racer, kidney(), options));
        EXPECT_EQ(to_string(result.end), "finished");
        EXPECT_EQ(result.wrong_unflagged, 0);
    }
}

TEST(Drivers, UnknownNamesAreRefused) {
    EXPECT_THROW(static_cast<void>(racers({"nobody"}, WithPlanner::no)), InvalidInput);
    EXPECT_THROW(static_cast<void>(racers({"front,front"}, WithPlanner::no)), InvalidInput);
    EXPECT_THROW(static_cast<void>(racers({"lanes:a=b.jsonl"}, WithPlanner::no)), InvalidInput);
    EXPECT_THROW(static_cast<void>(racers({"exec:a=b"}, WithPlanner::only)), InvalidInput);
    EXPECT_THROW(static_cast<void>(racers({"no-method"}, WithPlanner::only)), InvalidInput);
    const std::vector<Racer> both = racers({"truth,front"}, WithPlanner::both);
    ASSERT_EQ(both.size(), 3U);
    EXPECT_EQ(both[2].name, "front+planner");
}

}  // namespace
}  // namespace conelane::experiments
