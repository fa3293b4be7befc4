#include "experiments/race/dynamic_car.hpp"

namespace conelane::experiments {
namespace {

constexpr double kGravity_mps2 = 9.81;
constexpr double kRolling_mps = 1.0;  ///< slower, the slip angles fade: they are not defined at rest

}  // namespace

DynamicCar::DynamicCar(const Pose& rear_axle, double speed_mps, const DynamicCarParameters& parameters)
    : parameters_(parameters) {
    const Point middle = rear_axle.position + parameters.to_rear_m * rear_axle.heading();
    state_ = {middle.x(), middle.y(), rear_axle.yaw_rad, speed_mps, 0.0, 0.0};
}

Pose DynamicCar::rear_axle() const {
    const Pose middle{{state_[kX], state_[kY]}, std::remainder(state_[kYaw], 2.0 * std::numbers::pi)};
    return {middle.position - parameters_.to_rear_m * middle.heading(), middle.yaw_rad};
}

/// Across an axle, where `along_n` uses a part of its grip.
double DynamicCar::tyre_force_n(double slip_rad, double b, double load_n, double along_n) const {
    const DynamicCarParameters& p = parameters_;
    const double bent = b * slip_rad;
    const double shape = std::atan(bent * (1.0 - p.tyre_e) + p.tyre_e * std::atan(bent));
    const double used = along_n / (p.tyre_d * load_n);
    return p.tyre_d * load_n * std::sin(p.tyre_c * shape) * std::sqrt(std::max(0.0, 1.0 - used * used));
}

DynamicCar::State DynamicCar::rates(const State& state, double acceleration_mps2) const {
    const DynamicCarParameters& p = parameters_;
    const double ahead_mps = state[kAhead];
    const double rolling_mps = std::max(ahead_mps, kRolling_mps);
    const double turning_radps = state[kTurn];
    const double to_left_mps = state[kLeft];
    const double per_m_n = p.mass_kg * kGravity_mps2 / (p.to_front_m + p.to_rear_m);
    const double front_n = per_m_n * p.to_rear_m;
    const double rear_n = per_m_n * p.to_front_m;
    const double most_mps2 = p.tyre_d * kGravity_mps2;
    const double along_mps2 = std::clamp(acceleration_mps2, -most_mps2, most_mps2);
    const double front_slip_rad = steering_rad_ * ahead_mps / rolling_mps -
                                  std::atan2(to_left_mps + p.to_front_m * turning_radps, rolling_mps);
    const double rear_slip_rad = -std::atan2(to_left_mps - p.to_rear_m * turning_radps, rolling_mps);
    const double across_front_n =
        tyre_force_n(front_slip_rad, p.tyre_b[0], front_n, along_mps2 / kGravity_mps2 * front_n);
    const double across_rear_n =
        tyre_force_n(rear_slip_rad, p.tyre_b[1], rear_n, along_mps2 / kGravity_mps2 * rear_n);
    const double c = std::cos(steering_rad_);
    const double s = std::sin(steering_rad_);
    return {ahead_mps * std::cos(state[kYaw]) - to_left_mps * std::sin(state[kYaw]),
            ahead_mps * std::sin(state[kYaw]) + to_left_mps * std::cos(state[kYaw]),
            turning_radps,
            along_mps2 - across_front_n * s / p.mass_kg + to_left_mps * turning_radps,
            (across_front_n * c + across_rear_n) / p.mass_kg - ahead_mps * turning_radps,
            (p.to_front_m * across_front_n * c - p.to_rear_m * across_rear_n) / p.yaw_inertia_kgm2};
}

void DynamicCar::drive(double acceleration_mps2, double wanted_rad, double time_s) {
    commands_.emplace_back(acceleration_mps2, wanted_rad);
    std::pair<double, double> command;
    if (commands_.size() > static_cast<std::size_t>(std::lround(parameters_.delay_s / time_s))) {
        command = commands_.front();
        commands_.pop_front();
    }
    const SteeringLimits& steering = parameters_.steering;
    const double target_rad =
        std::clamp(command.second, -steering.max_steering_rad, steering.max_steering_rad);
    const double steps = std::ceil(time_s / parameters_.largest_step_s - 1e-9);
    const double step_s = time_s / steps;
    for (double i = 0.0; i < steps; ++i) {
        const double change_rad = steering.max_steering_rate_radps * step_s;
        steering_rad_ += std::clamp(target_rad - steering_rad_, -change_rad, change_rad);
        // The midpoint rule.
        State middle = state_;
        const State first = rates(state_, command.first);
        for (std::size_t k = 0; k < middle.size(); ++k) middle[k] += step_s / 2.0 * first[k];
        const State second = rates(middle, command.first);
        for (std::size_t k = 0; k < state_.size(); ++k) state_[k] += step_s * second[k];
        // The brakes do not drive it back.
        if (state_[kAhead] <= 0.0) state_[kAhead] = state_[kLeft] = state_[kTurn] = 0.0;
    }
}

}  // namespace conelane::experiments
