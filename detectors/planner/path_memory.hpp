#pragma once

#include "conelane/drivable_lane.hpp"
#include "conelane/scene.hpp"
#include "detectors/planner/lap_planner_settings.hpp"
#include "detectors/planner/rigid_shift.hpp"

#include <optional>

namespace conelane {

/// The lane that the car drives by, and its remaining part.
class PathMemory {
  public:
    explicit PathMemory(const LaneChoiceSettings& settings, double step_m, double max_age_s)
        : settings_(settings), step_m_(step_m), max_age_s_(max_age_s) {}

    /// Sets the lane, which begins at the car.
    void remember(const DrivableLane& lane, double time_s);
    void move_along(const RigidShift& shift);
    void forget() { lane_.reset(); }

    /// The lane from the car on: no points if there is none, it is too old, or the car is off it or at its
    /// end.
    [[nodiscard]] DrivableLane left(const Pose& pose, double time_s);
    /// Age of the frame that the lane is from.
    [[nodiscard]] double time_s() const { return time_s_; }

  private:
    LaneChoiceSettings settings_;
    double step_m_;
    double max_age_s_;
    std::optional<DrivableLane> lane_;
    double time_s_ = 0.0;
    double reached_m_ = 0.0;  ///< arc length that the car has reached
};

}  // namespace conelane
