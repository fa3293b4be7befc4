#pragma once

#include "detectors/planner/cone_memory.hpp"

namespace conelane {

/// Counts the start lines that the car crosses.
///
/// The line is the gate of orange cones that the first lane passes, or else the place of the first pose,
/// across its heading. It counts when the car passes it in its direction, and again after the car was away.
/// A run of one lap may end elsewhere: at another such gate, if nothing comes behind it.
class LapCounter {
  public:
    LapCounter(const CourseSettings& settings, int laps_of_run)
        : settings_(settings), laps_of_run_(laps_of_run) {}

    /// Adds the car's pose. `lane`: the lane ahead; without points it is unknown.
    void observe(const Pose& pose, const DrivableLane& lane, const ConeMemory& memory);
    void move_along(const RigidShift& shift);

    [[nodiscard]] int laps() const { return laps_; }
    /// The gate at which the course ends, if it is known.
    [[nodiscard]] std::optional<Pose> end() const { return course_ends_ ? finish_ : std::nullopt; }
    /// Distance along a lane from the car on to the line that ends the run, if the lane crosses it next.
    [[nodiscard]] std::optional<double> to_stop_line_m(const DrivableLane& lane) const;
    /// Distance driven since the last counted line [m].
    [[nodiscard]] double since_line_m() const { return since_line_m_; }

  private:
    /// The first gate ahead on a lane: near the first pose, or else away from the line.
    [[nodiscard]] std::optional<Pose> gate_on(const DrivableLane& lane, const ConeMemory& memory,
                                              bool near_start) const;
    [[nodiscard]] static bool nothing_ahead(const Pose& place, const ConeMemory& memory);
    [[nodiscard]] bool crosses(const Pose& line, const Pose& pose) const;

    CourseSettings settings_;
    int laps_of_run_;
    std::optional<Pose> first_;
    Pose line_;
    std::optional<Pose> finish_;  ///< another gate
    bool passed_finish_ = false;
    bool course_ends_ = false;  ///< nothing is ahead of that gate, or, behind it, of the car
    bool gate_ = false;
    std::optional<Pose> last_;
    bool away_ = false;  ///< far enough from the line since it counted
    int laps_ = 0;
    double driven_m_ = 0.0;
    double since_line_m_ = 0.0;
};

}  // namespace conelane
