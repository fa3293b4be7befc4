#pragma once

#include "conelane/planner.hpp"
#include "tests/support/drivable_checks.hpp"

namespace conelane::tests {

inline constexpr std::array<std::string_view, 6> kPhases{"approach", "right 1", "right 2",
                                                         "left 1",   "left 2",  "exit"};

/// Expects a valid plan for any frame. `pose`: the car's pose in the latest frame.
inline void expect_consistent(const Plan& plan, Mission mission, const Pose& pose) {
    SCOPED_TRACE(to_string(plan.state));
    const DrivableLane& lane = plan.lane;
    switch (plan.state) {
        case PlanState::searching:
        case PlanState::lost:
            EXPECT_TRUE(lane.points.empty());
            EXPECT_EQ(plan.safe_m, 0.0);
            EXPECT_FALSE(plan.stop);
            EXPECT_EQ(plan.reason.empty(), plan.state == PlanState::searching);
            break;
        case PlanState::following:
            EXPECT_GE(lane.points.size(), 2U);
            EXPECT_EQ(plan.age_s, 0.0);
            EXPECT_FALSE(plan.stop);
            break;
        case PlanState::bridging:
            EXPECT_GE(lane.points.size(), 2U);
            EXPECT_FALSE(plan.stop);
            break;
        case PlanState::finished:
            EXPECT_TRUE(plan.stop);
            break;
    }
    EXPECT_GE(plan.age_s, 0.0);
    EXPECT_GE(plan.safe_m, 0.0);
    EXPECT_LE(plan.safe_m, lane.length_m + 1e-9);
    EXPECT_GE(plan.lap, 0);
    if (mission == Mission::skidpad) {
        EXPECT_NE(std::ranges::find(kPhases, plan.phase), kPhases.end()) << plan.phase;
    } else {
        EXPECT_EQ(plan.phase, "");
    }
    if (lane.points.empty()) return;
    ASSERT_TRUE(all_finite(lane));
    EXPECT_FALSE(lane.closed) << "it begins at the car and ends ahead";
    if (lane.trusted_m) {
        EXPECT_LE(*lane.trusted_m, lane.length_m + 1e-9);
    }
    // The lane begins at the car and ends ahead of it.
    const DrivablePoint& first = lane.points.front();
    EXPECT_EQ(first.s_m, 0.0);
    EXPECT_LT(std::abs(pose.ahead_m(first.position)), 0.75);
    EXPECT_LT((first.position - pose.position).norm(), 2.5);
    EXPECT_GE(lane.length_m, lane.points.back().s_m - 1e-9);
    for (std::size_t i = 1; i < lane.points.size(); ++i) {
        const DrivablePoint& before = lane.points[i - 1];
        const DrivablePoint& here = lane.points[i];
        const double step_m = (here.position - before.position).norm();
        EXPECT_NEAR(here.s_m - before.s_m, step_m, 0.05 * (1e-3 + step_m)) << i;
        const Pose at{before.position, before.heading_rad};
        EXPECT_GT(at.ahead_m(here.position), 0.0) << "it turns back at " << i;
        EXPECT_GT(here.width_left_m, 0.0) << i;
        EXPECT_GT(here.width_right_m, 0.0) << i;
    }
}

/// Expects the same plan, to the bit.
inline void expect_same_plan(const Plan& a, const Plan& b) {
    EXPECT_EQ(a.state, b.state);
    EXPECT_EQ(a.safe_m, b.safe_m);
    EXPECT_EQ(a.age_s, b.age_s);
    EXPECT_EQ(a.lap, b.lap);
    EXPECT_EQ(a.stop, b.stop);
    EXPECT_EQ(a.phase, b.phase);
    EXPECT_EQ(a.answer.status, b.answer.status);
    EXPECT_EQ(a.answer.lane, b.answer.lane);
    ASSERT_EQ(a.lane.points.size(), b.lane.points.size());
    EXPECT_EQ(a.lane.length_m, b.lane.length_m);
    for (std::size_t i = 0; i < a.lane.points.size(); ++i) {
        EXPECT_EQ(a.lane.points[i].s_m, b.lane.points[i].s_m);
        EXPECT_EQ(a.lane.points[i].position, b.lane.points[i].position);
        EXPECT_EQ(a.lane.points[i].heading_rad, b.lane.points[i].heading_rad);
        EXPECT_EQ(a.lane.points[i].curvature_1pm, b.lane.points[i].curvature_1pm);
        EXPECT_EQ(a.lane.points[i].width_left_m, b.lane.points[i].width_left_m);
        EXPECT_EQ(a.lane.points[i].width_right_m, b.lane.points[i].width_right_m);
    }
}

}  // namespace conelane::tests
