// Speed along a path, compared with values recorded from TUMFTM trajectory_planning_helpers 0.79,
// calc_vel_profile: open path, no drag, ggv of constant ax_max and ay_max, dyn_model_exp 2, steps of 1 m.

#include "conelane/speed_profile.hpp"

#include "conelane/invalid_input.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

DrivableLane path(const std::function<double(double)>& curvature_1pm, double length_m = 40.0) {
    DrivableLane lane;
    for (double s_m = 0.0; s_m <= length_m; s_m += 1.0)
        lane.points.push_back({.s_m = s_m, .curvature_1pm = curvature_1pm(s_m)});
    lane.length_m = length_m;
    return lane;
}

DrivableLane bends() {
    return path([](double s_m) { return 0.12 * std::pow(std::sin(s_m / 6.0), 3); });
}

struct Recorded {
    VehicleLimits limits;
    SpeedTask task;
    std::vector<double> every_fourth_mps;
};

TEST(SpeedProfile, IsThatOfTrajectoryPlanningHelpers) {
    const std::vector<Recorded> all{
        {{9.0, 6.0, 4.0, 20.0},
         {8.0},
         {8.0, 9.797959, 8.692897, 9.028176, 10.603136, 11.796815, 9.703878, 8.673848, 9.471494, 11.032189,
          12.397951}},
        {{9.0, 6.0, 6.0, 12.0},
         {3.0, 40.0},
         {3.0, 7.548, 8.692897, 9.028176, 10.918942, 11.796815, 9.703878, 8.673848, 9.471494, 6.928116, 0.0}},
    };
    for (const Recorded& recorded : all) {
        const std::vector<SpeedPoint> profile = speed_profile(bends(), recorded.limits, recorded.task);
        ASSERT_EQ(profile.size(), 41U);
        for (std::size_t i = 0; i < recorded.every_fourth_mps.size(); ++i)
            EXPECT_NEAR(profile[4 * i].v_mps, recorded.every_fourth_mps[i], 1e-5) << 4 * i;
    }
}

TEST(SpeedProfile, StopsBetweenTwoPointsAndCountsTheTime) {
    const VehicleLimits limits{9.0, 6.0, 3.0, 20.0};
    const auto profile = speed_profile(path([](double) { return 0.0; }), limits, {0.0, 20.5});
    EXPECT_NEAR(profile[2].v_mps, std::sqrt(2.0 * 3.0 * 2.0), 1e-9);
    EXPECT_NEAR(profile[2].t_s, profile[2].v_mps / 3.0, 1e-9);
    EXPECT_NEAR(profile[20].v_mps, std::sqrt(2.0 * 6.0 * 0.5), 1e-9);
    EXPECT_EQ(profile[21].v_mps, 0.0);
    EXPECT_TRUE(std::isinf(profile[22].t_s));
    EXPECT_LT(speed_profile(path([](double) { return 0.0; }), limits, {15.0, 3.0}).front().v_mps, 15.0)
        << "too fast to stop there";
    EXPECT_TRUE(speed_profile({}).empty());
}

TEST(SpeedProfile, BrakesToAStopBetweenTwoPointsAndBehindTheLastOne) {
    for (const double stop_m : {0.5, 1.01, 2.5, 40.3}) {
        const auto profile = speed_profile(path([](double) { return 0.0; }), {}, {3.0, stop_m});
        double square = std::pow(profile.front().v_mps, 2);
        std::size_t i = 0;
        for (; i < profile.size() && profile[i].s_m < stop_m; ++i) {
            const double next_m = i + 1 < profile.size() ? std::min(profile[i + 1].s_m, stop_m) : stop_m;
            square += 2.0 * profile[i].a_mps2 * (next_m - profile[i].s_m);
        }
        EXPECT_NEAR(square, 0.0, 1e-9) << stop_m;
    }
}

TEST(SpeedProfile, RefusesWhatIsNoLimit) {
    EXPECT_THROW((void)speed_profile(bends(), {.a_drive_mps2 = 0.0}), InvalidInput);
    EXPECT_THROW((void)speed_profile(bends(), {.v_max_mps = std::nan("")}), InvalidInput);
    EXPECT_THROW((void)speed_profile(bends(), {}, {.v_now_mps = -1.0}), InvalidInput);
    EXPECT_THROW((void)speed_profile(bends(), {}, {.stop_at_m = std::nan("")}), InvalidInput);
    EXPECT_THROW((void)speed_profile(path([](double) { return std::nan(""); })), InvalidInput);
}

}  // namespace
}  // namespace conelane
