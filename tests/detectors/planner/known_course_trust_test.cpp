// After a lap the course is knowledge: trusted beyond the view until what is seen contradicts it.

#include "detectors/planner/lane_stretch.hpp"
#include "detectors/planner/rigid_shift.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/plan_checks.hpp"
#include "tests/support/planner_frames.hpp"

namespace conelane {
namespace {

constexpr double kStep_m = 0.6;

/// Laps of the oval, seen 12 m far, with other cones from the second lap on, in a map that may drift.
class KnownCourse : public testing::Test {
  protected:
    struct Seen {
        double s_m;
        Plan plan;
        double off_m;  ///< of the first 10 m of the path from the middle
    };
    /// Drives to the end of a lap, from 0; returns the plans of that lap.
    std::vector<Seen> drive_lap(int lap) {
        std::vector<Seen> seen;
        for (; s_m_ < (lap + 1) * course_.lap_m; s_m_ += kStep_m, time_s_ += 0.1) {
            SCOPED_TRACE(s_m_);
            const double laps = s_m_ / course_.lap_m;
            const RigidShift drift{{0.0, 0.0}, laps * turn_rad_, laps * Point(drift_m_, 0.0)};
            tests::DrivenCourse now = lap > 0 && changed_ ? *changed_ : course_;
            for (Cone& cone : now.cones) cone.position = drift(cone.position);
            now.pose = [this, drift](double s_m) {
                const Pose at = course_.pose(s_m);
                return Pose{drift(at.position), at.yaw_rad + drift.turn_rad};
            };
            Frame frame = frame_at(now, s_m_, time_s_, {.range_m = 12.0, .noise_m = 0.05}, &random_);
            const Point ahead = frame.pose.heading();
            frame.pose.position += aside_m_ * Point(-ahead.y(), ahead.x());
            Plan plan = planner_->update(frame, tests::kNoTimeLimit);
            tests::expect_consistent(plan, Mission::trackdrive, frame.pose);
            // The car drives by the path, also where the lane is not where it was.
            if (changed_) aside_m_ = now.pose(s_m_ + kStep_m).left_m(point_at(plan.lane, kStep_m).position);
            DrivableLane near = plan.lane;
            std::erase_if(near.points, [](const DrivablePoint& point) { return point.s_m > 10.0; });
            seen.push_back({s_m_, std::move(plan), farthest_from_middle_m(now, s_m_, near)});
        }
        return seen;
    }
    /// The cones from `from_m` to `to_m` along the course, moved to the left.
    void change(double from_m, double to_m, double left_m, bool only_right = false) {
        changed_ = course_;
        for (Cone& cone : changed_->cones) {
            for (double s_m = from_m; s_m <= to_m; s_m += 0.1) {
                const Pose at = course_.pose(s_m);
                const double aside_m = at.left_m(cone.position);
                if ((cone.position - at.position).norm() > 1.8 || (only_right && aside_m > 0.0)) continue;
                cone.position += left_m * Point(-std::sin(at.yaw_rad), std::cos(at.yaw_rad));
                break;
            }
        }
    }
    /// The share of the plans that are trusted for at least 20 m.
    static double far_share(const std::vector<Seen>& seen) {
        const auto far = std::ranges::count_if(seen, [](const Seen& s) { return s.plan.safe_m >= 20.0; });
        return static_cast<double>(far) / static_cast<double>(seen.size());
    }
    static std::set<std::string_view> reasons(const std::vector<Seen>& seen) {
        std::set<std::string_view> all;
        for (const Seen& s : seen) all.insert(s.plan.reason);
        return all;
    }

    tests::DrivenCourse course_ = tests::oval(4);
    std::optional<tests::DrivenCourse> changed_;
    double drift_m_ = 0.0;
    double turn_rad_ = 0.0;
    std::unique_ptr<Planner> planner_ = make_planner({.laps = 4});
    std::mt19937 random_{7};
    double s_m_ = 0.0;
    double time_s_ = 0.0;
    double aside_m_ = 0.0;  ///< of the car from the middle of the course as it was
};

TEST_F(KnownCourse, IsTrustedBeyondTheView) {
    EXPECT_LT(far_share(drive_lap(0)), 0.1) << "the view ends after 12 m";
    const std::vector<Seen> seen = drive_lap(1);
    EXPECT_GT(far_share(seen), 0.9);
    for (const Seen& s : seen) EXPECT_LT(s.off_m, 0.4) << s.s_m;
    EXPECT_GT(far_share(drive_lap(2)), 0.99);
}

/// Once the place is near, nothing beyond what a frame shows is trusted past it.
TEST_F(KnownCourse, IsNotTrustedPastAConeThatMovedIntoTheLaneOrAGateThatMoved) {
    for (const bool is_gate : {false, true}) {
        planner_->reset();
        s_m_ = aside_m_ = 0.0;
        const double at_m = course_.lap_m / 2.0;
        change(at_m - 1.0, at_m + 1.0, is_gate ? 1.5 : 1.2, !is_gate);
        (void)drive_lap(0);
        const std::vector<Seen> seen = drive_lap(1);
        for (const Seen& s : seen) {
            const double to_it_m = 1.5 * course_.lap_m - s.s_m;
            if (to_it_m < 1.5 || to_it_m > 6.0) continue;
            EXPECT_LT(s.plan.safe_m, 12.0) << s.s_m;
            EXPECT_FALSE(s.plan.reason.empty()) << s.s_m;
        }
        EXPECT_TRUE(is_gate || reasons(seen).contains("a cone stands in the lane"));
        EXPECT_GT(far_share(seen), 0.6) << "elsewhere it is";
    }
}

TEST_F(KnownCourse, IsTrustedInAMapThatDrifts) {
    drift_m_ = 0.5;
    turn_rad_ = 2.0 * tests::kPi / 180.0;
    (void)drive_lap(0);
    for (const int lap : {1, 2}) {
        const std::vector<Seen> seen = drive_lap(lap);
        EXPECT_GT(far_share(seen), 0.8) << lap;
        for (const Seen& s : seen) EXPECT_LT(s.off_m, 0.6) << s.s_m;
    }
}

TEST_F(KnownCourse, ThatChangedBetweenLapsIsDrivenAsItIsNow) {
    const double from_m = course_.lap_m / 2.0 - 7.0;
    change(from_m, from_m + 14.0, 1.2);
    (void)drive_lap(0);
    EXPECT_GE(reasons(drive_lap(1)).size(), 2U) << "the plan says why";
    for (const Seen& s : drive_lap(2)) {
        const double there_m = std::fmod(s.s_m, course_.lap_m) - from_m;
        if (there_m < 2.0 || there_m > 10.0) continue;
        EXPECT_NEAR(course_.pose(s.s_m).left_m(s.plan.lane.points.front().position), 1.2, 0.6) << s.s_m;
    }
}

}  // namespace
}  // namespace conelane
