// Acceleration and skidpad through the planner: its plans from the start to the stop, and in frames whose
// cones say nothing.

#include "detectors/planner/planners.hpp"
#include "tests/detectors/planner/known_event.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

using known_event::in_map;
using known_event::kCircle_m;
using known_event::Sight;
using known_event::skidpad_route;

const Pose kCourse{{40.0, -25.0}, 2.3};

std::unique_ptr<Planner> planner_of(Mission mission) {
    return make_known_course_planner({.mission = mission, .detector = "front"});
}

/// No time limit, so that the result does not depend on the machine's load.
constexpr DetectionLimits kNoLimit{.time_limit_ms = std::numeric_limits<double>::infinity()};

Pose acceleration_route(double s_m) {
    return {{s_m, 0.0}, 0.0};
}

/// A car that keeps to the route at 6 m/s and 10 Hz.
class Car {
  public:
    Car(Mission mission, unsigned seed, double noise_m = 0.1)
        : is_skidpad_(mission == Mission::skidpad),
          at_m_(is_skidpad_ ? -16.0 : -2.0),
          sight_(is_skidpad_ ? known_event::skidpad_cones() : known_event::acceleration_cones(1.9), noise_m,
                 0.05, seed) {}

    Frame next(const Pose& course = kCourse) {
        Frame frame = sight_.look(pose(), course, time_s_);
        last_s_m_ = at_m_;
        time_s_ += 0.1;
        at_m_ += 0.6;
        return frame;
    }
    [[nodiscard]] Pose pose() const { return is_skidpad_ ? skidpad_route(at_m_) : acceleration_route(at_m_); }
    /// In the last frame.
    [[nodiscard]] double s_m() const { return last_s_m_; }
    [[nodiscard]] Pose route(double s_m) const {
        return is_skidpad_ ? skidpad_route(s_m) : acceleration_route(s_m);
    }

  private:
    bool is_skidpad_;
    double at_m_;
    double last_s_m_ = 0.0;
    double time_s_ = 0.0;
    Sight sight_;
};

/// The largest distance of the first 10 m of a lane from the route ahead.
double error_of(const DrivableLane& lane, const Car& car, const Pose& course) {
    double worst_m = 0.0;
    for (const DrivablePoint& point : lane.points) {
        if (point.s_m > 10.0) break;
        worst_m = std::max(
            worst_m, (in_map(course, car.route(car.s_m() + point.s_m)).position - point.position).norm());
    }
    return worst_m;
}

TEST(KnownCoursePlanner, SkidpadIsDrivenInOrderToTheStop) {
    for (unsigned seed = 0; seed < 3; ++seed) {
        const auto planner = planner_of(Mission::skidpad);
        Car car(Mission::skidpad, seed);
        std::vector<std::string> phases;
        int lap = 0;
        while (car.s_m() < 4.0 * kCircle_m + 15.0) {
            const Plan plan = planner->update(car.next(), kNoLimit);
            if (phases.empty() || phases.back() != plan.phase) phases.emplace_back(plan.phase);
            EXPECT_GE(plan.lap, lap);
            lap = plan.lap;
            if (car.s_m() < 4.0 * kCircle_m) {
                EXPECT_EQ(plan.state, PlanState::following) << car.s_m();
                EXPECT_FALSE(plan.stop) << car.s_m();
            }
            if (car.s_m() > 4.0 * kCircle_m + 3.0) {
                EXPECT_EQ(plan.state, PlanState::finished);
                EXPECT_TRUE(plan.stop);
                // What is left ends within 25 m past the line.
                EXPECT_NEAR(car.s_m() + plan.lane.length_m, 4.0 * kCircle_m + 25.0, 1.0);
            }
            if (car.s_m() > -15.0) {
                EXPECT_LT(error_of(plan.lane, car, kCourse), 0.45) << car.s_m();
            }
            EXPECT_LE(plan.safe_m, plan.lane.length_m);
        }
        EXPECT_THAT(phases,
                    testing::ElementsAre("approach", "right 1", "right 2", "left 1", "left 2", "exit"));
        EXPECT_EQ(lap, 4);
    }
}

TEST(KnownCoursePlanner, AFarFalseConeInTheFirstFrameHidesNoCourse) {
    for (const double far_m : {30.0, 60.0, 200.0}) {
        const auto planner = planner_of(Mission::acceleration);
        Car car(Mission::acceleration, 1);
        for (int i = 0; i < 30; ++i) {
            Frame frame = car.next();
            const Point far = frame.pose.position + far_m * frame.pose.heading();
            if (i == 0) frame.cones.push_back({kNoId, far});
            EXPECT_EQ(planner->update(frame, kNoLimit).state, PlanState::following) << far_m << " m, " << i;
        }
    }
}

TEST(KnownCoursePlanner, AccelerationStopsBehindTheLineAndNeverBefore) {
    for (unsigned seed = 0; seed < 5; ++seed) {
        const auto planner = planner_of(Mission::acceleration);
        Car car(Mission::acceleration, seed);
        double stop_m = 0.0;
        while (car.s_m() < 90.0) {
            const Plan plan = planner->update(car.next(), kNoLimit);
            if (plan.stop && stop_m == 0.0) stop_m = car.s_m();
            EXPECT_EQ(plan.phase, "");
            EXPECT_EQ(plan.lap, 0);
            EXPECT_EQ(plan.stop, plan.state == PlanState::finished);
            EXPECT_LT(error_of(plan.lane, car, kCourse), 0.4) << car.s_m();
        }
        EXPECT_GT(stop_m, 75.0);
        EXPECT_LT(stop_m, 78.5);
    }
}

TEST(KnownCoursePlanner, RowsAcrossTheExitShortenWhatIsLeft) {
    for (const double row_m : {25.0, 60.0}) {
        std::vector<Point> cones;
        for (const Point& cone : known_event::acceleration_cones(1.9)) {
            if (cone.x() < 75.0 + row_m - 1.0) cones.push_back(cone);
        }
        for (const double y_m : {-1.9, 0.0, 1.9}) cones.emplace_back(75.0 + row_m, y_m);
        Sight sight(cones, 0.1, 0.05, 1);
        const auto planner = planner_of(Mission::acceleration);
        Plan plan;
        for (int i = 0; i < 10 * (75 + static_cast<int>(row_m) - 10) / 6; ++i) {
            const Pose pose = acceleration_route(-2.0 + 0.6 * i);
            plan = planner->update(sight.look(pose, kCourse, 0.1 * i), kNoLimit);
        }
        ASSERT_TRUE(plan.stop);
        ASSERT_FALSE(plan.lane.points.empty());
        const Point end = plan.lane.points.back().position;
        const double ahead_m = kCourse.ahead_m(end);
        EXPECT_LT(ahead_m, 75.0 + row_m - 1.0);
        EXPECT_GT(ahead_m, 75.0 + row_m - 3.5);
    }
}

TEST(KnownCoursePlanner, IsLostIfTheConesStopSupportingTheRegistration) {
    for (const Mission mission : {Mission::acceleration, Mission::skidpad}) {
        const auto planner = planner_of(mission);
        Car car(mission, 1);
        for (int i = 0; i < 40; ++i) static_cast<void>(planner->update(car.next(), kNoLimit));
        int lost = 0;
        for (int i = 0; i < 40; ++i) {
            Frame frame = car.next();
            frame.cones.clear();
            const auto strewn = Sight::strewn(25, frame.pose.position, 15.0, static_cast<unsigned>(100 + i));
            for (const Point& point : strewn) frame.cones.push_back({kNoId, point});
            const Plan plan = planner->update(frame, kNoLimit);
            EXPECT_EQ(plan.age_s > 0.0, plan.state != PlanState::following);
            if (plan.state == PlanState::lost) {
                ++lost;
                EXPECT_TRUE(plan.lane.points.empty());
                EXPECT_FALSE(plan.stop);
            }
        }
        EXPECT_GT(lost, 15) << to_string(mission);
    }
}

TEST(KnownCoursePlanner, WithoutConesItGoesOnForAWhileAndComesBack) {
    for (const Mission mission : {Mission::acceleration, Mission::skidpad}) {
        const auto planner = planner_of(mission);
        Car car(mission, 2);
        for (int i = 0; i < 40; ++i) static_cast<void>(planner->update(car.next(), kNoLimit));
        for (int i = 0; i < 25; ++i) {
            Frame frame = car.next();
            frame.cones.clear();
            const Plan plan = planner->update(frame, kNoLimit);
            EXPECT_EQ(plan.state, i < 10 ? PlanState::bridging : PlanState::lost) << i;
            EXPECT_NEAR(plan.age_s, 0.1 * (i + 1), 1e-9);
            if (i < 10) {
                EXPECT_LT(error_of(plan.lane, car, kCourse), 0.45);
            }
        }
        Plan plan;
        for (int i = 0; i < 5; ++i) plan = planner->update(car.next(), kNoLimit);
        EXPECT_EQ(plan.state, PlanState::following);
        EXPECT_LT(error_of(plan.lane, car, kCourse), 0.45);
    }
}

TEST(KnownCoursePlanner, ComesBackAfterTheMapHasJumped) {
    // A jump by 2 m and 9 degrees at once, of the cones and the pose.
    for (const Mission mission : {Mission::acceleration, Mission::skidpad}) {
        const auto planner = planner_of(mission);
        Car car(mission, 3);
        for (int i = 0; i < 40; ++i) static_cast<void>(planner->update(car.next(), kNoLimit));
        // Around the car, like a correction of a map.
        const Pose before = in_map(kCourse, car.pose());
        Pose course = kCourse;
        course.yaw_rad += 0.15;
        course.position += before.position + Point(1.4, -1.4) - in_map(course, car.pose()).position;
        Plan plan;
        for (int i = 0; i < 12; ++i) {
            plan = planner->update(car.next(course), kNoLimit);
            if (plan.state == PlanState::following && i > 8) {
                EXPECT_LT(error_of(plan.lane, car, course), 0.5) << to_string(mission) << " " << i;
            }
        }
        EXPECT_EQ(plan.state, PlanState::following) << to_string(mission);
        EXPECT_FALSE(plan.stop);
    }
}

TEST(KnownCoursePlanner, ACarThatStandsStillMakesNoProgress) {
    const auto planner = planner_of(Mission::skidpad);
    Sight sight(known_event::skidpad_cones(), 0.2, 0.1, 4);
    for (int i = 0; i < 300; ++i) {
        const Plan plan = planner->update(sight.look(skidpad_route(-0.8), kCourse, 0.1 * i), kNoLimit);
        EXPECT_NE(plan.phase, "right 2");
        EXPECT_EQ(plan.lap, 0);
    }
}

TEST(KnownCoursePlanner, KeepsTheTimeLimitOfASearch) {
    // Without time, nothing is found; the first frame with time is enough.
    const auto planner = planner_of(Mission::skidpad);
    Sight sight(known_event::skidpad_cones(), 0.1, 0.0, 6);
    for (int i = 0; i < 5; ++i) {
        const Plan plan =
            planner->update(sight.look(skidpad_route(-16.0), kCourse, 0.1 * i), {.time_limit_ms = 0.0});
        EXPECT_EQ(plan.state, PlanState::searching);
        EXPECT_TRUE(plan.lane.points.empty());
    }
    const Plan plan = planner->update(sight.look(skidpad_route(-16.0), kCourse, 1.0), kNoLimit);
    EXPECT_EQ(plan.state, PlanState::following);
    EXPECT_GT(plan.lane.length_m, 20.0);
}

}  // namespace
}  // namespace conelane
