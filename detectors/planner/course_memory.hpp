#pragma once

#include "detectors/planner/cone_memory.hpp"

namespace conelane {

/// How far a lane is trusted, and why not farther; without a reason, to its end.
struct LaneTrust {
    double length_m = 0.0;
    std::string_view reason;
};

/// The centre line where the car has driven, and the cones beside it; after a lap, the closed course.
///
/// It always holds the last lap: the lane at the car replaces the old part of the course, so a changed course
/// is known after it was driven once more. The course ahead is laid onto the cones of each frame: a map that
/// drifts moves it.
class CourseMemory {
  public:
    CourseMemory(const CourseSettings& settings, double step_m) : settings_(settings), step_m_(step_m) {}

    /// Adds the lane at the car, and the cones there. `lane` begins at the car; a lane without points
    /// interrupts the record.
    void record(const DrivableLane& lane, const ConeMemory& cones);
    /// Compares the cones beside the course ahead with those of a frame, which `cones` has observed.
    void observe(const Frame& frame, const ConeMemory& cones);
    /// Moves the course ahead of the car towards the lane of a frame that runs beside it.
    void lean_on(const DrivableLane& seen);
    void move_along(const RigidShift& shift);

    [[nodiscard]] bool closed() const { return closed_; }
    /// The circuit from its first recorded point on; absent until it is closed.
    [[nodiscard]] std::optional<DrivableLane> course() const;
    /// The course from the car on, laid onto the cones; no points until it is closed, or if the car is off
    /// it.
    [[nodiscard]] DrivableLane ahead(const Pose& pose, double length_m) const;
    /// Whether the cones of the last frame show that the course is right.
    [[nodiscard]] bool is_confirmed() const { return closed_ && fit_ > 0 && matched_ >= 2; }
    /// How far nothing that was seen contradicts `lane`, a result of `ahead`: cones that do not fit the
    /// course, a cone in the lane that was not there, a cone of the boundary that is gone.
    [[nodiscard]] LaneTrust trust(const DrivableLane& lane, const ConeMemory& cones) const;

  private:
    /// A cone beside the recorded points.
    struct NotedCone {
        Point place;
        double s_m = 0.0;  ///< of the recorded point
        bool is_boundary = false;
        int missed = 0;  ///< frames in a row that should have shown it
    };
    void append(const DrivablePoint& point, const ConeMemory& cones);
    void close(const DrivableLane& lane);
    void drop_passed(const DrivablePoint& at);
    void note_cones(const DrivablePoint& here, const ConeMemory& cones);

    CourseSettings settings_;
    double step_m_;
    std::vector<DrivablePoint> points_;  ///< oldest first; s_m counts on from the first point of the run
    std::vector<NotedCone> noted_;       ///< in the same order
    RigidShift laid_;                    ///< from the recorded places to those of the cones now
    int fit_ = 0;      ///< frames that fitted the course, less those that did not, within fitting_frames
    int matched_ = 0;  ///< noted cones that the last frame showed
    bool closed_ = false;
};

}  // namespace conelane
