#pragma once

#include "conelane/drivable_lane.hpp"
#include "conelane/scene.hpp"
#include "detectors/planner/lap_planner_settings.hpp"
#include "detectors/planner/rigid_shift.hpp"

#include <optional>
#include <vector>

namespace conelane {

/// The centre line where the car has driven; after a lap, the closed course.
///
/// It always holds the last lap: the lane at the car replaces the old part of the course, so a changed course
/// is known after it was driven once more.
class CourseMemory {
  public:
    CourseMemory(const CourseSettings& settings, double step_m) : settings_(settings), step_m_(step_m) {}

    /// Adds the lane at the car. `lane` begins at the car; a lane without points interrupts the record.
    void record(const DrivableLane& lane);
    void move_along(const RigidShift& shift) { move(points_, shift); }

    [[nodiscard]] bool closed() const { return closed_; }
    /// The circuit from its first recorded point on; absent until it is closed.
    [[nodiscard]] std::optional<DrivableLane> course() const;
    /// The course from the car on, shifted to the lane at the car; no points until it is closed, or if the
    /// car is off it.
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
