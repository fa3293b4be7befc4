// The contract of a planner (see planner.hpp), for every mission with every detector of the library. A new
// detector is tested here as soon as it is listed.

#include "conelane/invalid_input.hpp"
#include "tests/support/detector_names.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/plan_checks.hpp"
#include "tests/support/planner_frames.hpp"

namespace conelane {
namespace {

using tests::course_of;
using tests::DrivenCourse;
using tests::expect_consistent;
using tests::expect_same_plan;
using tests::frame_at;
using tests::kNoTimeLimit;
using tests::Sight;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kFrame_s = 0.1;
constexpr double kDriven_m = 0.5;  ///< from frame to frame
constexpr int kFrames = 16;

/// Missions by detectors.
class PlannerContract : public testing::TestWithParam<std::tuple<Mission, std::string>> {
  protected:
    static Mission mission() { return std::get<0>(GetParam()); }
    static std::unique_ptr<Planner> make() {
        return make_planner({.mission = mission(), .detector = std::get<1>(GetParam())});
    }
    Frame frame(int i, const Sight& sight = {}) const {
        return frame_at(course_, kDriven_m * i, kFrame_s * i, sight);
    }
    Plan update(Planner& planner, const Frame& frame) const {
        Plan plan = planner.update(frame, kNoTimeLimit);
        expect_consistent(plan, mission(), frame.pose);
        return plan;
    }
    std::vector<Plan> drive(Planner& planner, const Sight& sight = {}, int frames = kFrames) const {
        std::vector<Plan> plans;
        for (int i = 0; i < frames; ++i) {
            SCOPED_TRACE(i);
            plans.push_back(update(planner, frame(i, sight)));
        }
        return plans;
    }

    DrivenCourse course_ = course_of(mission());
};

TEST_P(PlannerContract, FollowsTheMiddleOfTheLaneFromTheCarOn) {
    const std::vector<Plan> plans = drive(*make());
    const auto following =
        std::ranges::count(plans, PlanState::following, [](const Plan& plan) { return plan.state; });
    EXPECT_GE(following, kFrames - 2) << "the first frames may be searched";
    for (int i = 0; i < kFrames; ++i) {
        const Plan& plan = plans[static_cast<std::size_t>(i)];
        EXPECT_EQ(plan.lap, 0);
        if (plan.state != PlanState::following) continue;
        EXPECT_GT(plan.lane.length_m, 8.0) << i;
        EXPECT_GT(plan.safe_m, 3.0) << i;
        DrivableLane safe = plan.lane;
        std::erase_if(safe.points, [&](const DrivablePoint& point) { return point.s_m > plan.safe_m; });
        EXPECT_LT(tests::farthest_from_middle_m(course_, kDriven_m * i, safe), 0.6) << i;
    }
}

TEST_P(PlannerContract, AnInvalidFrameIsRefusedAndChangesNothing) {
    struct Fault {
        std::string key;
        void (*make)(Frame&, DetectionLimits&);
    };
    const std::vector<Fault> faults{
        {"cones[3].x", [](Frame& f, DetectionLimits&) { f.cones[3].position.x() = kNaN; }},
        {"cones[2].y", [](Frame& f, DetectionLimits&) { f.cones[2].position.y() = kInfinity; }},
        {"cones[1].confidence", [](Frame& f, DetectionLimits&) { f.cones[1].confidence = 1.5; }},
        {"cones[4].id", [](Frame& f, DetectionLimits&) { f.cones[4].id = f.cones[0].id; }},
        {"pose.x", [](Frame& f, DetectionLimits&) { f.pose.position.x() = kNaN; }},
        {"pose.yaw", [](Frame& f, DetectionLimits&) { f.pose.yaw_rad = -kInfinity; }},
        {"time_s", [](Frame& f, DetectionLimits&) { f.time_s = kNaN; }},
        {"time_s", [](Frame& f, DetectionLimits&) { f.time_s = kInfinity; }},
        {"time_limit_ms", [](Frame&, DetectionLimits& l) { l.time_limit_ms = kNaN; }},
    };
    const std::vector<Plan> expected = drive(*make());
    const auto planner = make();
    for (int i = 0; i < kFrames; ++i) {
        SCOPED_TRACE(i);
        const Fault& fault = faults[static_cast<std::size_t>(i) % faults.size()];
        Frame broken = frame(i);
        DetectionLimits limits = kNoTimeLimit;
        fault.make(broken, limits);
        try {
            (void)planner->update(broken, limits);
            ADD_FAILURE() << fault.key << " is accepted";
        } catch (const InvalidInput& error) {
            EXPECT_THAT(error.key(), testing::HasSubstr(fault.key));
        }
        expect_same_plan(update(*planner, frame(i)), expected[static_cast<std::size_t>(i)]);
    }
}

TEST_P(PlannerContract, ThePlansDependOnTheFramesAlone) {
    const std::vector<Plan> expected = drive(*make());
    const auto planner = make();
    // After another run that was not driven to its end.
    for (int i = 0; i < 8; ++i) {
        (void)planner->update(frame_at(course_, 20.0 + kDriven_m * i, 50.0 + kFrame_s * i), kNoTimeLimit);
    }
    planner->reset();
    EXPECT_FALSE(planner->course());
    const std::vector<Plan> again = drive(*planner);
    for (std::size_t i = 0; i < expected.size(); ++i) {
        SCOPED_TRACE(i);
        expect_same_plan(again[i], expected[i]);
    }
}

TEST_P(PlannerContract, TheOrderOfConesAndWhereTimeBeginsChangeNothing) {
    const std::vector<Plan> expected = drive(*make());
    const auto planner = make();
    for (int i = 0; i < kFrames; ++i) {
        SCOPED_TRACE(i);
        Frame other = frame(i);
        std::ranges::reverse(other.cones);
        other.time_s -= 1000.0;
        const Plan plan = update(*planner, other);
        const Plan& same = expected[static_cast<std::size_t>(i)];
        EXPECT_EQ(plan.state, same.state);
        ASSERT_NEAR(plan.lane.length_m, same.lane.length_m, 1e-6);
        for (std::size_t k = 0; k < same.lane.points.size(); ++k) {
            EXPECT_LT((plan.lane.points[k].position - same.lane.points[k].position).norm(), 1e-6);
        }
    }
}

TEST_P(PlannerContract, WithoutConesItBridgesAndIsThenLost) {
    const auto planner = make();
    Frame none;
    none.pose = course_.pose(0.0);
    none.time_s = -1.0;
    const Plan nothing = update(*planner, none);
    EXPECT_EQ(nothing.state, PlanState::searching);
    EXPECT_EQ(nothing.answer.lane, Lane{});
    ASSERT_EQ(drive(*planner).back().state, PlanState::following);
    double age_s = 0.0;
    PlanState state = PlanState::bridging;
    for (int i = kFrames; i < kFrames + 20; ++i) {
        SCOPED_TRACE(i);
        Frame blind = frame(i);
        blind.cones.clear();
        const Plan plan = update(*planner, blind);
        if (i == kFrames) {
            EXPECT_EQ(plan.state, PlanState::bridging);
        }
        if (plan.state == PlanState::bridging) {
            EXPECT_EQ(state, PlanState::bridging) << "lost, and found without a cone";
            EXPECT_GT(plan.age_s, age_s);
            EXPECT_LE(plan.age_s, 1.0 + 1e-9);
            age_s = plan.age_s;
        } else {
            EXPECT_EQ(plan.state, PlanState::lost);
        }
        state = plan.state;
    }
    EXPECT_GT(age_s, 0.4) << "half a second without cones is bridged";
    EXPECT_EQ(state, PlanState::lost) << "a lane older than a second is no path";
}

TEST_P(PlannerContract, FramesThatComeTwiceAreAnsweredTwiceAndOldOnesAreFlagged) {
    const std::vector<Plan> expected = drive(*make());
    const auto planner = make();
    for (int i = 0; i < kFrames; ++i) {
        SCOPED_TRACE(i);
        const Plan plan = update(*planner, frame(i));
        expect_same_plan(plan, expected[static_cast<std::size_t>(i)]);
        expect_same_plan(planner->update(frame(i), kNoTimeLimit), plan);
        Frame other = frame(i);
        other.cones.front().position.x() += 0.3;
        EXPECT_NE(planner->update(other, kNoTimeLimit).state, PlanState::following) << "a clock that stands";
        if (i < 3) continue;
        const Plan late = planner->update(frame(i - 3), kNoTimeLimit);
        EXPECT_NE(late.state, PlanState::following);
        EXPECT_EQ(late.reason.empty(), late.state != PlanState::bridging && plan.reason.empty());
        const double moved_m = (frame(i).pose.position - frame(i - 3).pose.position).norm();
        EXPECT_EQ(late.safe_m, std::max(0.0, plan.safe_m - moved_m));
        EXPECT_EQ(late.lane.points.size(), plan.lane.points.size());
    }
}

TEST_P(PlannerContract, IdsMayBeMissingOrChange) {
    const std::vector<Plan> expected = drive(*make());
    struct Naming {
        const char* name;
        ConeId (*id)(const Cone&, int);
    };
    const std::vector<Naming> namings{
        {"none", [](const Cone&, int) { return kNoId; }},
        {"half", [](const Cone& c, int) { return c.id % 2 == 0 ? c.id : kNoId; }},
        {"other ones each frame", [](const Cone& c, int i) { return c.id + 1000 * i; }},
        {"exchanged each frame", [](const Cone& c, int i) { return i % 2 == 0 ? c.id : c.id ^ 1; }},
        {"huge and negative",
         [](const Cone& c, int) { return c.id % 2 == 0 ? -c.id - 1 : kNoId + 1 + c.id; }},
    };
    for (const Naming& naming : namings) {
        SCOPED_TRACE(naming.name);
        const auto planner = make();
        int following = 0;
        for (int i = 0; i < kFrames; ++i) {
            SCOPED_TRACE(i);
            Frame named = frame(i);
            for (Cone& cone : named.cones) cone.id = naming.id(cone, i);
            const Plan plan = update(*planner, named);
            if (plan.state != PlanState::following) continue;
            ++following;
            DrivableLane near = plan.lane;
            std::erase_if(near.points, [](const DrivablePoint& point) { return point.s_m > 6.0; });
            EXPECT_LT(tests::farthest_from_middle_m(course_, kDriven_m * i, near), 0.5);
        }
        EXPECT_GE(following, kFrames - 3);
    }
}

TEST_P(PlannerContract, TheAnswerNamesConesAsTheCarDoes) {
    const auto planner = make();
    for (int i = 0; i < kFrames; ++i) {
        const Frame seen = frame(i);
        const Plan plan = update(*planner, seen);
        for (const std::vector<ConeId>& side : {plan.answer.lane.left, plan.answer.lane.right}) {
            for (const ConeId id : side) {
                EXPECT_TRUE(std::ranges::any_of(course_.cones, [&](const Cone& c) { return c.id == id; }))
                    << id;
            }
        }
    }
}

TEST_P(PlannerContract, ATimeLimitNeverMakesAPlanWrong) {
    const auto planner = make();
    for (int i = 0; i < kFrames; ++i) {
        SCOPED_TRACE(i);
        const Frame seen = frame(i);
        const Plan plan = planner->update(seen, {.time_limit_ms = i % 2 == 0 ? 0.0 : 5.0});
        expect_consistent(plan, mission(), seen.pose);
    }
}

TEST_P(PlannerContract, AMapThatJumpsIsFollowed) {
    const auto planner = make();
    const Point jump(0.4, -0.3);
    (void)drive(*planner);
    int following = 0;
    for (int i = kFrames; i < kFrames + 8; ++i) {
        SCOPED_TRACE(i);
        Frame moved = frame(i);
        moved.pose.position += jump;
        for (Cone& cone : moved.cones) cone.position += jump;
        Plan plan = update(*planner, moved);
        following += plan.state == PlanState::following ? 1 : 0;
        for (DrivablePoint& point : plan.lane.points) point.position -= jump;
        std::erase_if(plan.lane.points, [](const DrivablePoint& point) { return point.s_m > 6.0; });
        EXPECT_LT(tests::farthest_from_middle_m(course_, kDriven_m * i, plan.lane), 0.5);
    }
    EXPECT_GE(following, 6);
}

TEST_P(PlannerContract, ACarThatIsSetElsewhereHasNoStalePath) {
    const auto planner = make();
    (void)drive(*planner);
    for (int i = kFrames; i < kFrames + 4; ++i) {
        SCOPED_TRACE(i);
        Frame elsewhere = frame(i);
        elsewhere.cones.clear();
        elsewhere.pose.position += Point(300.0, -200.0);
        EXPECT_TRUE(update(*planner, elsewhere).lane.points.empty());
    }
}

INSTANTIATE_TEST_SUITE_P(All, PlannerContract,
                         testing::Combine(testing::Values(Mission::trackdrive, Mission::autocross,
                                                          Mission::acceleration, Mission::skidpad),
                                          testing::ValuesIn(tests::detector_names())),
                         [](const auto& test) {
                             return std::string(to_string(std::get<0>(test.param))) + "_" +
                                    case_name(std::get<1>(test.param));
                         });

TEST(PlannerOptions, ThatAreOutOfRangeOrNotUsedAreRefused) {
    const auto refused = [](const PlannerOptions& options) -> std::string {
        try {
            (void)make_planner(options);
        } catch (const InvalidInput& error) {
            return error.key();
        }
        return "accepted";
    };
    for (const Mission mission : {Mission::trackdrive, Mission::autocross}) {
        EXPECT_EQ(refused({.mission = mission, .laps = 0}), "laps");
        EXPECT_EQ(refused({.mission = mission, .laps = -3}), "laps");
        EXPECT_EQ(refused({.mission = mission, .laps = 1}), "accepted");
    }
    for (const Mission mission : {Mission::acceleration, Mission::skidpad}) {
        EXPECT_EQ(refused({.mission = mission, .laps = 1}), "laps") << "the rules say how often";
    }
    for (const Mission mission :
         {Mission::trackdrive, Mission::autocross, Mission::acceleration, Mission::skidpad}) {
        EXPECT_EQ(refused({.mission = mission, .detector = "magic"}), "detector");
        EXPECT_EQ(refused({.mission = mission, .detector = "clc", .detector_options = {.weights = "w.json"}}),
                  "weights");
        for (const double step_m : {0.0, 5.1, kNaN, kInfinity})
            EXPECT_EQ(refused({.mission = mission, .drivable = {.step_m = step_m}}), "step_m");
        EXPECT_EQ(refused({.mission = mission, .max_age_s = -0.1}), "max_age_s");
        EXPECT_EQ(refused({.mission = mission, .max_age_s = kNaN}), "max_age_s");
        EXPECT_EQ(refused({.mission = mission, .max_age_s = 0.0}), "accepted");
    }
    EXPECT_EQ(refused({.mission = static_cast<Mission>(9)}), "mission");
}

TEST(PlannerOptions, AStepIsTheStepOfTheLane) {
    for (const Mission mission : {Mission::trackdrive, Mission::acceleration}) {
        const DrivenCourse course = course_of(mission);
        const auto planner = make_planner({.mission = mission, .drivable = {.step_m = 0.2}});
        Plan plan;
        for (int i = 0; i < 4; ++i) {
            plan = planner->update(frame_at(course, kDriven_m * i, kFrame_s * i), kNoTimeLimit);
        }
        ASSERT_GT(plan.lane.points.size(), 20U);
        EXPECT_NEAR(plan.lane.points[10].s_m, 2.0, 1e-9);
    }
}

TEST(PlannerOptions, WithoutAgeThereIsNoBridge) {
    for (const Mission mission : {Mission::trackdrive, Mission::acceleration}) {
        const DrivenCourse course = course_of(mission);
        const auto planner = make_planner({.mission = mission, .max_age_s = 0.0});
        for (int i = 0; i < 4; ++i) {
            (void)planner->update(frame_at(course, kDriven_m * i, kFrame_s * i), kNoTimeLimit);
        }
        const Plan plan = planner->update({0.5, course.pose(2.0), {}}, kNoTimeLimit);
        EXPECT_EQ(plan.state, PlanState::lost);
    }
}

}  // namespace
}  // namespace conelane
