#pragma once

#include "experiments/race/world.hpp"

#include <deque>
#include <utility>

namespace conelane::experiments {

/// Mass, inertia and tyres are those of the car `gotthard` of FSSIM (AMZ-Racing/fssim,
/// fssim_description/cars/gotthard/config/car.yaml), without its aerodynamics. The wheelbase is that of all
/// races. The delay is an assumption.
struct DynamicCarParameters {
    double mass_kg = 190.0;
    double yaw_inertia_kgm2 = 110.0;
    double to_front_m = 0.775;  ///< from the centre of gravity to the front axle
    double to_rear_m = 0.775;
    /// Magic Formula of an axle: force / load = d sin(c atan(b (1 - e) slip + e atan(b slip))), slip in rad.
    std::array<double, 2> tyre_b{12.56, 12.56};  ///< front and rear
    double tyre_c = 1.38;
    double tyre_d = 1.60;
    double tyre_e = -0.58;
    SteeringLimits steering = {};
    double delay_s = 0.05;         ///< from a command to steering, motor and brake
    double largest_step_s = 1e-3;  ///< of the integration
};

/// A single-track car with slip: constant axle loads, a force across each axle that saturates, and a friction
/// ellipse with the force along it, which axles share by load (Rajamani, Vehicle Dynamics and Control,
/// chapters 2 and 13). Below 1 m/s the slip angles fade so that the wheels roll as those of `Vehicle`.
class DynamicCar {
  public:
    /// `rear_axle`: where it stands or rolls straight on.
    DynamicCar(const Pose& rear_axle, double speed_mps, const DynamicCarParameters& parameters = {});

    /// Moves on for `time_s`, the same in each call. The commands reach the car after the delay: the
    /// acceleration along it, and the angle that the steering follows within its limits.
    void drive(double acceleration_mps2, double wanted_rad, double time_s);

    [[nodiscard]] Pose rear_axle() const;
    [[nodiscard]] double speed_mps() const { return state_[kAhead]; }  ///< along the car

  private:
    /// Place [m] and heading [rad] of the centre of gravity; speeds ahead and to the left [m/s]; yaw rate.
    using State = std::array<double, 6>;
    enum : std::size_t { kX, kY, kYaw, kAhead, kLeft, kTurn };
    [[nodiscard]] double tyre_force_n(double slip_rad, double b, double load_n, double along_n) const;
    [[nodiscard]] State rates(const State& state, double acceleration_mps2) const;

    DynamicCarParameters parameters_;
    State state_;
    double steering_rad_ = 0.0;
    std::deque<std::pair<double, double>> commands_;  ///< on their way: acceleration and steering
};

}  // namespace conelane::experiments
