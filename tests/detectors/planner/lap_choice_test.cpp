// The choice between the lane driven so far and one that jumps away from it; noise from frame to frame;
// frames without progress of time.

#include "detectors/planner/lane_choice.hpp"
#include "detectors/planner/lane_stretch.hpp"
#include "detectors/planner/planners.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/planner_frames.hpp"
#include "tests/support/straight_line.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

DrivableLane line(double heading_rad) {
    return tests::straight_line({0.0, 0.0}, heading_rad, 20.0);
}

/// A choice whose lane is supported by many certain frames.
class SureChoice : public testing::Test {
  protected:
    SureChoice() {
        EXPECT_TRUE(choice_.take(lane_, DrivableLane{}, 0.95));
        for (int i = 0; i < 30; ++i) EXPECT_TRUE(choice_.take(lane_, lane_, 0.95));
    }
    /// The number of frames until `other` is driven; 1000 if it never is.
    int frames_until_left(const DrivableLane& other, double weight, double kept_weight) {
        int frames = 1;
        while (frames < 1000 && !choice_.take(other, lane_, weight, kept_weight)) ++frames;
        return frames;
    }

    LaneChoiceSettings settings_;
    LaneChoice choice_{settings_};
    DrivableLane lane_ = line(0.0);
    DrivableLane other_ = line(0.5);
};

TEST_F(SureChoice, IsKeptAgainstUncertainFrames) {
    EXPECT_GT(frames_until_left(other_, 0.3, 0.0), 10);
}

TEST_F(SureChoice, IsLeftForCertainFrames) {
    const int frames = frames_until_left(other_, 0.95, 0.0);
    EXPECT_GT(frames, 1);
    EXPECT_LE(frames, static_cast<int>(std::ceil(settings_.max_support / 0.95)));
}

TEST_F(SureChoice, IsLeftAlsoWhereCandidatesSpeakForIt) {
    EXPECT_LE(frames_until_left(other_, 0.5, 0.3), 20);
}

TEST_F(SureChoice, IsNotLeftForFramesThatContradictEachOther) {
    const DrivableLane third = line(-0.5);
    for (int i = 0; i < 50; ++i) EXPECT_FALSE(choice_.take(i % 2 == 0 ? other_ : third, lane_, 1.0));
}

TEST(LaneChoice, FramesThatSpeakForTheLaneDrivenByHoldANewOneUp) {
    const DrivableLane lane = line(0.0);
    const DrivableLane other = line(0.5);
    int frames[2];
    for (const bool is_kept : {false, true}) {
        LaneChoice choice{LaneChoiceSettings{}};
        EXPECT_TRUE(choice.take(lane, DrivableLane{}, 0.9));
        int& count = frames[is_kept ? 1 : 0];
        count = 1;
        while (count < 1000 && !choice.take(other, lane, 0.5, is_kept ? 0.3 : 0.0)) ++count;
    }
    EXPECT_EQ(frames[0], 2) << "one frame against two";
    EXPECT_GT(frames[1], frames[0]);
    EXPECT_LT(frames[1], 10) << "and no trap";
}

/// Straight on, then from `bend_m` on in another direction.
DrivableLane bent(double bend_m, double heading_rad) {
    DrivableLane lane = line(0.0);
    const Point at(bend_m, 0.0);
    for (DrivablePoint& point : lane.points) {
        if (point.s_m <= bend_m) continue;
        point.position = at + (point.s_m - bend_m) * Point(std::cos(heading_rad), std::sin(heading_rad));
        point.heading_rad = heading_rad;
    }
    return lane;
}

TEST(LaneChoice, AStretchHasNoSupportFromFramesThatDidNotSeeIt) {
    // Certain frames saw only 5 m; then one uncertain frame continued to the left.
    const auto frames_until_right = [&](double unsure_left_m) {
        LaneChoice choice{LaneChoiceSettings{}};
        DrivableLane seen = line(0.0);
        seen.points.resize(11);
        seen.length_m = 5.0;
        EXPECT_TRUE(choice.take(seen, DrivableLane{}, 0.95));
        for (int i = 0; i < 20; ++i) EXPECT_TRUE(choice.take(seen, seen, 0.95));
        const DrivableLane left = bent(5.0, unsure_left_m);
        EXPECT_TRUE(choice.take(left, seen, 0.1)) << "it goes on along what was seen";
        int frames = 1;
        while (frames < 100 && !choice.take(bent(5.0, -0.8), left, 0.6)) ++frames;
        return frames;
    };
    EXPECT_EQ(frames_until_right(0.8), 2) << "two surer frames outweigh it";
}

DrivableLane line_aside(double left_m, double width_m = 3.5) {
    DrivableLane lane = tests::straight_line({0.0, left_m}, 0.0, 20.0);
    for (DrivablePoint& point : lane.points) point.width_left_m = point.width_right_m = width_m / 2.0;
    lane.trusted_m = 15.0;
    return lane;
}

TEST(Steadied, NearTheCarNoiseMovesTheLineHalfAsMuchAndTheWidthsSaySo) {
    const DrivableLane lane = steadied(line_aside(0.4), line_aside(0.0), 0.5);
    for (const DrivablePoint& point : lane.points) {
        EXPECT_NEAR(point.width_left_m - point.width_right_m, 2.0 * (0.4 - point.position.y()), 1e-6);
        if (point.s_m > 0.6 && point.s_m < 7.5) {
            EXPECT_NEAR(point.position.y(), 0.2, 1e-6);
        }
        if (point.s_m > 12.6) {
            EXPECT_NEAR(point.position.y(), 0.4, 1e-6);
        }
    }
    ASSERT_TRUE(lane.trusted_m);
    EXPECT_NEAR(*lane.trusted_m, 15.0, 1e-9);
    EXPECT_NEAR(lane.points[10].s_m, 5.0, 1e-9) << "equal steps";
}

TEST(Steadied, ALaneThatIsElsewhereStays) {
    for (const DrivablePoint& point : steadied(line_aside(1.0), line_aside(0.0), 0.5).points) {
        EXPECT_NEAR(point.position.y(), 1.0, 1e-9);
    }
    EXPECT_EQ(steadied(line_aside(1.0), {}, 0.5).points.size(), line(0.0).points.size());
}

TEST(Steadied, TheLineComesNoNearerToABoundary) {
    for (const DrivablePoint& point : steadied(line_aside(0.4, 2.0), line_aside(0.0, 2.0), 0.5).points) {
        EXPECT_NEAR(point.position.y(), 0.4, 1e-9);
    }
}

/// A straight lane of cones ahead of a car at x; those from `from_x_m` to `to_x_m`.
Frame straight_frame(double time_s, double x_m, double from_x_m, double to_x_m) {
    Frame frame{time_s, {{x_m, 0.0}, 0.0}, {}};
    for (int i = 0; i < 60; ++i) {
        if (3.0 * i < from_x_m || 3.0 * i > to_x_m) continue;
        frame.cones.push_back({2 * i, {3.0 * i, 1.75}});
        frame.cones.push_back({2 * i + 1, {3.0 * i, -1.75}});
    }
    return frame;
}

TEST(LapPlanner, AShortLaneDoesNotEndThePath) {
    // The map forgets the far cones at once: their ids change, and only near cones are seen.
    const auto planner = make_planner({.detector = "front"});
    Plan plan;
    for (int i = 0; i < 8; ++i) {
        plan = planner->update(straight_frame(0.1 * i, 0.6 * i, 0.6 * i, 0.6 * i + 20.0),
                               {.time_limit_ms = 1e4});
    }
    ASSERT_EQ(plan.state, PlanState::following);
    ASSERT_GT(plan.lane.length_m, 14.0);
    const double end_x_m = plan.lane.points.back().position.x();
    plan = planner->update(straight_frame(0.8, 4.8, 4.8, 12.0), {.time_limit_ms = 1e4});
    ASSERT_EQ(plan.state, PlanState::following);
    EXPECT_GT(plan.lane.points.back().position.x(), end_x_m - 1.0);
    EXPECT_GT(plan.safe_m, 12.0 - 4.8) << "three frames have trusted more";
    EXPECT_LE(plan.safe_m, plan.lane.length_m);
}

TEST(LapPlanner, InLaterLapsAFrameWithoutALaneIsBridgedByTheCourse) {
    // The car sees 9 m, then nothing. In the second lap it knows the bend behind what it has seen.
    const tests::DrivenCourse course = tests::oval(3);
    for (const bool is_later : {false, true}) {
        const auto planner = make_planner({.detector = "front", .laps = 3});
        const double blind_m = course.lap_m / 2.0 + 6.0 + (is_later ? course.lap_m : 0.0);
        int i = 0;
        for (; 0.6 * i < blind_m; ++i) {
            (void)planner->update(frame_at(course, 0.6 * i, 0.1 * i, {.range_m = 9.0}),
                                  {.time_limit_ms = 1e4});
        }
        ASSERT_EQ(planner->course().has_value(), is_later);
        for (int blind = 0; blind < 5; ++blind, ++i) {
            const Plan plan = planner->update({0.1 * i, course.pose(0.6 * i), {}}, {.time_limit_ms = 1e4});
            ASSERT_EQ(plan.state, PlanState::bridging);
            EXPECT_NEAR(plan.age_s, 0.1 * (blind + 1), 1e-6) << "the course does not make it younger";
            EXPECT_LE(plan.safe_m, is_later ? 50.0 : 9.0) << "what frames showed, and the course";
            if (!is_later) {
                EXPECT_LT(plan.lane.length_m, 12.0);
                continue;
            }
            EXPECT_GT(plan.lane.length_m, 15.0);
            EXPECT_LT(tests::farthest_from_middle_m(course, 0.6 * i, plan.lane), 0.5);
        }
        for (int blind = 5; blind < 12; ++blind, ++i) {
            (void)planner->update({0.1 * i, course.pose(0.6 * i), {}}, {.time_limit_ms = 1e4});
        }
        EXPECT_EQ(planner->update({0.1 * i, course.pose(0.6 * i), {}}, {.time_limit_ms = 1e4}).state,
                  PlanState::lost)
            << "also a known course is driven blind for max_age_s only";
    }
}

/// Answers what the test says.
class ScriptedDetector : public LaneDetector {
  public:
    explicit ScriptedDetector(std::function<LaneAnswer(const Scene&)> script) : script_(std::move(script)) {}

  protected:
    LaneAnswer search(const Scene& scene, const DetectionLimits& /*limits*/) override {
        return script_(scene);
    }

  private:
    std::function<LaneAnswer(const Scene&)> script_;
};

std::optional<ConeId> cone_at(const Scene& scene, const Point& position) {
    for (const Cone& cone : scene.cones) {
        if ((cone.position - position).norm() < 0.01) return cone.id;
    }
    return std::nullopt;
}

/// The oval and a second row of gates 3 m to the right of its own: a lane may change from one to the other.
class OvalWithRivals {
  public:
    [[nodiscard]] const tests::DrivenCourse& course() const { return course_; }
    /// The frame of a car at `s_m`; ids differ from those of the rivals.
    [[nodiscard]] Frame frame(double s_m, double time_s, bool with_rivals) const {
        Frame seen = tests::frame_at(course_, s_m, time_s);
        if (!with_rivals) return seen;
        for (const int gate : ahead(s_m)) {
            const auto [left, right] = at(gate, true);
            seen.cones.push_back({1000 + 2 * gate, left});
            seen.cones.push_back({1001 + 2 * gate, right});
        }
        return seen;
    }
    /// The next five gates, those more than `leaves_m` ahead from the second row; on the right only, or on
    /// both sides.
    [[nodiscard]] Lane lane(const Scene& scene, double s_m, double leaves_m, bool on_both = true) const {
        Lane result;
        for (const int gate : ahead(s_m)) {
            const bool is_rival = gate * spacing_m_ - s_m > leaves_m;
            result.left.push_back(cone_at(scene, at(gate, is_rival && on_both).first).value());
            result.right.push_back(cone_at(scene, at(gate, is_rival).second).value());
        }
        return result;
    }

  private:
    [[nodiscard]] std::vector<int> ahead(double s_m) const {
        const int first = static_cast<int>(std::ceil(s_m / spacing_m_));
        return {first, first + 1, first + 2, first + 3, first + 4};
    }
    [[nodiscard]] std::pair<Point, Point> at(int gate, bool is_rival) const {
        const Pose pose = course_.pose(gate * spacing_m_);
        const Point left(-std::sin(pose.yaw_rad), std::cos(pose.yaw_rad));
        const double aside_m = is_rival ? -3.0 : 0.0;
        return {pose.position + (aside_m + 1.75) * left, pose.position + (aside_m - 1.75) * left};
    }

    tests::DrivenCourse course_ = tests::oval(3);
    const double spacing_m_ = course_.lap_m / (static_cast<double>(course_.cones.size()) / 2.0);
};

TEST(LapPlanner, InLaterLapsTheCourseReplacesACandidateThatLeavesItFartherOn) {
    // In the second lap, the detector answers with a lane that leaves the course 3 m ahead. Its second lane
    // leaves it 11 m ahead, beyond the 8 m that are compared.
    const OvalWithRivals oval;
    double s_m = 0.0;
    bool is_wrong = false;
    const auto planner =
        make_lap_planner({.laps = 3}, std::make_unique<ScriptedDetector>([&](const Scene& scene) {
                             LaneAnswer answer;
                             answer.status = LaneStatus::found;
                             answer.lane = oval.lane(scene, s_m, is_wrong ? 3.0 : 100.0);
                             answer.confidence = is_wrong ? 0.3 : 0.95;
                             answer.trusted_m = is_wrong ? 0.0 : 10.0;
                             if (is_wrong)
                                 answer.enumeration = {1, true, {{oval.lane(scene, s_m, 11.0), 1, 0.2}}};
                             return answer;
                         }));
    int i = 0;
    for (; s_m < oval.course().lap_m + 20.0; ++i, s_m += 0.6) {
        ASSERT_EQ(planner->update(oval.frame(s_m, 0.1 * i, false), tests::kNoTimeLimit).state,
                  PlanState::following)
            << s_m;
    }
    ASSERT_TRUE(planner->course());
    is_wrong = true;
    for (int wrong = 1; wrong <= 4; ++wrong, ++i, s_m += 0.6) {
        const Plan plan = planner->update(oval.frame(s_m, 0.1 * i, true), tests::kNoTimeLimit);
        EXPECT_EQ(plan.state, PlanState::following) << "the cones confirm the course, frame " << wrong;
        EXPECT_GT(plan.lane.length_m, 15.0);
        EXPECT_LT(tests::farthest_from_middle_m(oval.course(), s_m, plan.lane), 0.5);
    }
}

TEST(LapPlanner, AWrongLaneOfTheFirstLapIsLeftForATrustedOneAndForgotten) {
    // In the first lap, over 15 m of the upper straight, the detector takes the right boundary of the second
    // row: a lane of 6.5 m whose middle is 1.5 m beside the true one. Later it is right.
    const OvalWithRivals oval;
    const double lap_m = oval.course().lap_m;
    double s_m = 0.0;
    const auto is_in_wrong = [&](double at_m) {
        return std::fmod(at_m, lap_m) > 0.39 * lap_m && std::fmod(at_m, lap_m) < 0.56 * lap_m;
    };
    const auto planner =
        make_lap_planner({.laps = 4}, std::make_unique<ScriptedDetector>([&](const Scene& scene) {
                             LaneAnswer answer;
                             answer.status = LaneStatus::found;
                             const bool is_wrong = s_m < lap_m && is_in_wrong(s_m);
                             answer.lane = oval.lane(scene, s_m, is_wrong ? -100.0 : 100.0, false);
                             answer.confidence = 0.95;
                             answer.trusted_m = 10.0;
                             return answer;
                         }));
    std::array<double, 3> off_m{};  // largest distance of the first 6 m from the true middle, by lap
    bool is_told = false;
    double least_m = 100.0;  // trusted in the third lap
    for (int i = 0; s_m < 3.0 * lap_m - 1.0; ++i, s_m += 0.6) {
        Plan plan = planner->update(oval.frame(s_m, 0.1 * i, true), tests::kNoTimeLimit);
        if (!is_in_wrong(s_m)) continue;
        const auto lap = static_cast<std::size_t>(s_m / lap_m);
        std::erase_if(plan.lane.points, [](const DrivablePoint& point) { return point.s_m > 6.0; });
        off_m[lap] = std::max(off_m[lap], tests::farthest_from_middle_m(oval.course(), s_m, plan.lane));
        is_told = is_told || (lap == 1 && plan.reason == "a trusted lane leaves the course");
        if (lap == 2) least_m = std::min(least_m, plan.safe_m);
    }
    EXPECT_GT(off_m[0], 1.2);
    EXPECT_LT(off_m[1], 0.9);
    EXPECT_TRUE(is_told);
    EXPECT_LT(off_m[2], 0.4);
    EXPECT_GT(least_m, 20.0) << "the course is right and trusted beyond the view";
}

TEST(LapPlanner, AFrameOfTheSameTimeAtAnotherPoseIsNotFollowed) {
    const auto planner = make_planner({.detector = "front"});
    Frame frame{1.0, {{0.0, 0.0}, 0.0}, {}};
    for (int i = 0; i < 6; ++i) {
        frame.cones.push_back({2 * i, {3.0 * i, 1.75}});
        frame.cones.push_back({2 * i + 1, {3.0 * i, -1.75}});
    }
    ASSERT_EQ(planner->update(frame, {.time_limit_ms = 1e4}).state, PlanState::following);
    EXPECT_EQ(planner->update(frame, {.time_limit_ms = 1e4}).state, PlanState::following) << "it came twice";
    frame.pose.position.x() += 0.6;
    EXPECT_EQ(planner->update(frame, {.time_limit_ms = 1e4}).state, PlanState::bridging);
    frame.time_s += 0.1;
    EXPECT_EQ(planner->update(frame, {.time_limit_ms = 1e4}).state, PlanState::following);
}

}  // namespace
}  // namespace conelane
