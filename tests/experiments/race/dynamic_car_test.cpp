// The car with slip against closed forms.

#include "experiments/race/dynamic_car.hpp"

#include "tests/support/testing.hpp"

namespace conelane::experiments {
namespace {

constexpr double kStep_s = 0.01;

/// Drives on at a constant speed; returns the yaw rate at the end.
double turn_radps(DynamicCar& car, double speed_mps, double steering_rad, double for_s) {
    double before_rad = 0.0;
    for (double t_s = 0.0; t_s < for_s; t_s += kStep_s) {
        before_rad = car.rear_axle().yaw_rad;
        car.drive((speed_mps - car.speed_mps()) / 0.1, steering_rad, kStep_s);
    }
    return std::remainder(car.rear_axle().yaw_rad - before_rad, 2.0 * std::numbers::pi) / kStep_s;
}

TEST(DynamicCar, DrivesStraightAndBrakesToRest) {
    DynamicCarParameters parameters;
    parameters.delay_s = 0.0;
    DynamicCar car({{1.0, 2.0}, std::numbers::pi / 2.0}, 10.0, parameters);
    for (int i = 0; i < 100; ++i) car.drive(0.0, 0.0, kStep_s);
    EXPECT_NEAR((car.rear_axle().position - Point(1.0, 12.0)).norm(), 0.0, 1e-9);
    for (int i = 0; i < 300; ++i) car.drive(-5.0, 0.0, kStep_s);
    EXPECT_EQ(car.speed_mps(), 0.0) << "brakes do not drive it back";
    EXPECT_NEAR(car.rear_axle().position.y(), 12.0 + 100.0 / (2.0 * 5.0), 0.01);
}

// Steady state: steering = wheelbase / radius + K a with the understeer gradient K = (1 / stiffness of the
// front - 1 / that of the rear) / g, where the stiffness of an axle is b c d of its load.
TEST(DynamicCar, CornersByTheUndersteerGradient) {
    constexpr double kAcross_mps2 = 1.0;  // the closed form is that of small slip
    for (const double front_b : {8.0, 12.56, 16.0}) {
        SCOPED_TRACE(front_b);
        DynamicCarParameters parameters;
        parameters.tyre_b[0] = front_b;
        parameters.to_front_m = 0.7;
        parameters.to_rear_m = 0.85;
        const double cd = parameters.tyre_c * parameters.tyre_d;
        const double gradient = (1.0 / (front_b * cd) - 1.0 / (parameters.tyre_b[1] * cd)) / 9.81;
        for (const double speed_mps : {5.0, 10.0}) {
            DynamicCar car({{0.0, 0.0}, 0.0}, speed_mps, parameters);
            const double turn = kAcross_mps2 / speed_mps;
            const double steering_rad = 1.55 * turn / speed_mps + gradient * kAcross_mps2;
            EXPECT_NEAR(turn_radps(car, speed_mps, steering_rad, 4.0), turn, 0.01 * turn) << speed_mps;
        }
    }
}

TEST(DynamicCar, ASmallerStepChangesNothing) {
    const auto drive = [](double step_s) {
        DynamicCarParameters parameters;
        parameters.largest_step_s = step_s;
        DynamicCar car({{0.0, 0.0}, 0.0}, 8.0, parameters);
        for (int i = 0; i < 300; ++i) car.drive(2.0 * std::sin(0.02 * i), 0.15 * std::sin(0.03 * i), kStep_s);
        return car.rear_axle().position;
    };
    const Point exact = drive(1e-5);
    const double coarse_m = (drive(2e-3) - exact).norm();
    const double fine_m = (drive(1e-3) - exact).norm();
    EXPECT_LT(fine_m, 1e-3);
    EXPECT_LT(fine_m, coarse_m);
}

TEST(DynamicCar, TyresSaturateAndCommandsComeLate) {
    DynamicCar car({{0.0, 0.0}, 0.0}, 15.0);
    for (int i = 0; i < 5; ++i) car.drive(0.0, 0.5, kStep_s);
    EXPECT_EQ(car.rear_axle().yaw_rad, 0.0) << "the delay is 0.05 s";
    double most_mps2 = 0.0;
    Point before = car.rear_axle().position;
    Point last_mps(15.0, 0.0);
    for (int i = 0; i < 100; ++i) {
        car.drive(0.0, 0.5, kStep_s);
        const Point speed_mps = (car.rear_axle().position - before) / kStep_s;
        if (i > 50) most_mps2 = std::max(most_mps2, (speed_mps - last_mps).norm() / kStep_s);
        last_mps = speed_mps;
        before = car.rear_axle().position;
    }
    EXPECT_LT(most_mps2, 1.1 * 1.6 * 9.81) << "the kinematic car would need 79 m/s^2";
}

}  // namespace
}  // namespace conelane::experiments
