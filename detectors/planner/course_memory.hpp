#pragma once

#include "conelane/drivable_lane.hpp"
#include "conelane/scene.hpp"
#include "detectors/planner/lap_planner_settings.hpp"
#include "detectors/planner/rigid_shift.hpp"

#include <optional>
#include <vector>

namespace conelane {

/// The centre line where the car has driven: once it has come round, the closed course.
///
/// It always holds the last lap: what the car passes replaces what was there, so that a changed course is
/// known after the car has driven it once.
class CourseMemory {
  public:
    CourseMemory(const CourseSettings& settings, double step_m) : settings_(settings), step_m_(step_m) {}

    /// Takes in the lane at the car. `lane` begins at the car; without points the record is interrupted.
    void record(const DrivableLane& lane);
    void move_along(const RigidShift& shift);
    void clear();

    [[nodiscard]] bool closed() const { return closed_; }
    /// The circuit from its first recorded point on; absent before it is closed.
    [[nodiscard]] std::optional<DrivableLane> course() const;
    /// The course from the car on, laid through where the lane is at the car; no points before it is closed,
    /// or where the car is off it.
    [[nodiscard]] DrivableLane ahead(const Pose& pose, double length_m) const;

  private:
    void append(const DrivablePoint& point);
    void close(const DrivableLane& lane);
    void drop_passed(const DrivablePoint& at);

    CourseSettings settings_;
    double step_m_;
    std::vector<DrivablePoint> points_;  ///< oldest first; s_m counts on from the first point of the run
    bool closed_ = false;
};

}  // namespace conelane
