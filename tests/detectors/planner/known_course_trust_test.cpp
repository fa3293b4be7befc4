// After a lap the course is knowledge: trusted beyond the view until what is seen contradicts it.

#include "conelane/planner.hpp"
#include "detectors/planner/lane_stretch.hpp"
#include "detectors/planner/rigid_shift.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/plan_checks.hpp"
#include "tests/support/planner_frames.hpp"
#include "tests/support/testing.hpp"

#include <random>
#include <set>

namespace conelane {
namespace {

constexpr double kStep_m = 0.6;

/// Three laps of the oval, seen 12 m far, with other cones from the second lap on, in a map that may drift.
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
            tests::DrivenCourse now = lap > 0 && changed_ ? *changed_ : course_;
            Frame frame = frame_at(now, s_m_, time_s_, {.range_m = 12.0, .noise_m = noise_m_}, &random_);
            const double share = s_m_ / course_.lap_m;
            for (Cone& cone : frame.cones) cone.position = drifted(cone.position, share);
            frame.pose = {drifted(frame.pose.position, share), frame.pose.yaw_rad + share * turn_rad_};
            const Point ahead = frame.pose.heading();
            frame.pose.position += aside_m_ * Point(-ahead.y(), ahead.x());
            Plan plan = planner_->update(frame, tests::kNoTimeLimit);
            SCOPED_TRACE(s_m_);
            tests::expect_consistent(plan, Mission::trackdrive, frame.pose);
            // The car drives by the path, also where the lane is not where it was.
            if (changed_) {
                const Pose next = course_.pose(s_m_ + kStep_m);
                aside_m_ = next.left_m(point_at(plan.lane, kStep_m).position);
            }
            DrivableLane near = plan.lane;
            std::erase_if(near.points, [](const DrivablePoint& point) { return point.s_m > 10.0; });
            for (DrivablePoint& point : near.points) point.position = undrifted(point.position, share);
            seen.push_back({s_m_, std::move(plan), farthest_from_middle_m(course_, s_m_, near)});
        }
        return seen;
    }
    [[nodiscard]] Point drifted(const Point& place, double share) const {
        return RigidShift{{0.0, 0.0}, share * turn_rad_, share * Point(drift_m_, 0.0)}(place);
    }
    [[nodiscard]] Point undrifted(const Point& place, double share) const {
        return RigidShift{{0.0, 0.0}, -share * turn_rad_}(place - share * Point(drift_m_, 0.0));
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
    /// Expects that once the place is near, nothing beyond what this frame shows is trusted past it.
    static void expect_not_trusted_past(const std::vector<Seen>& seen, double at_m) {
        for (const Seen& s : seen) {
            const double to_it_m = at_m - s.s_m;
            if (to_it_m < 1.5 || to_it_m > 6.0) continue;
            EXPECT_LT(s.plan.safe_m, 12.0) << s.s_m;
            EXPECT_FALSE(s.plan.reason.empty()) << s.s_m;
        }
    }

    tests::DrivenCourse course_ = tests::oval(4);
    std::optional<tests::DrivenCourse> changed_;
    double drift_m_ = 0.0;
    double turn_rad_ = 0.0;
    double noise_m_ = 0.05;
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

TEST_F(KnownCourse, IsNotTrustedPastAConeThatMovedIntoTheLane) {
    change(course_.lap_m / 2.0 - 1.0, course_.lap_m / 2.0 + 1.0, 1.2, true);
    (void)drive_lap(0);
    const std::vector<Seen> seen = drive_lap(1);
    expect_not_trusted_past(seen, 1.5 * course_.lap_m);
    EXPECT_TRUE(reasons(seen).contains("a cone stands in the lane"));
    EXPECT_GT(far_share(seen), 0.6) << "elsewhere it is";
}

TEST_F(KnownCourse, IsNotTrustedPastAGateThatMoved) {
    change(course_.lap_m / 2.0 - 1.0, course_.lap_m / 2.0 + 1.0, 1.5);
    (void)drive_lap(0);
    const std::vector<Seen> seen = drive_lap(1);
    expect_not_trusted_past(seen, 1.5 * course_.lap_m);
    EXPECT_GT(far_share(seen), 0.6);
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
    const std::vector<Seen> seen = drive_lap(1);
    EXPECT_GE(reasons(seen).size(), 2U) << "the plan says why";
    const auto in_change = [&](const Seen& s) {
        const double there_m = std::fmod(s.s_m, course_.lap_m) - from_m;
        return there_m > 2.0 && there_m < 10.0;
    };
    for (const Seen& s : drive_lap(2)) {
        if (!in_change(s)) continue;
        const Pose at = course_.pose(s.s_m);
        EXPECT_NEAR(at.left_m(s.plan.lane.points.front().position), 1.2, 0.6) << s.s_m;
    }
}

}  // namespace
}  // namespace conelane
