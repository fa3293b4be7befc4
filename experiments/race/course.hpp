#pragma once

#include "conelane/planner.hpp"
#include "evaluation/world/track.hpp"

namespace conelane::experiments {

/// The course of a race. Positions are true ones, in the frame of the course.
struct RaceCourse {
    std::string name;
    std::vector<Cone> cones;  ///< with their true colors
    std::vector<Pose> line;   ///< the true centre line from the start to the end, one pose every step_m
    bool closed = false;      ///< the line returns to its start; otherwise it is driven once
    double step_m = 0.25;
    double length_m = 0.0;  ///< of the line; once around if it is closed
    TrackBoundaries lane;   ///< the lane that must not be left; empty if `half_width_m` defines it
    /// The lane is everything within this distance of the line; where lines cross, only of the stretch being
    /// driven.
    std::optional<double> half_width_m;
    Mission mission = Mission::trackdrive;
    double start_m = 0.0;                       ///< along the line: start position of the car
    std::optional<double> finish_m = {};        ///< along the line; absent for a closed course
    double rest_m = 0.0;                        ///< past the finish: the car must be at rest there
    std::vector<std::string_view> phases = {};  ///< phases that a planner must report, in order
};

/// A closed course with annotated boundaries, starting at its first left cone. Throws InvalidInput if the
/// track is not closed, and like centre_line_poses.
[[nodiscard]] RaceCourse circuit(const Track& track);

/// Acceleration by the rules: a straight lane 3.8 m wide, cones every 5 m, big cones at the start line at
/// x = 0 and at the finish 75 m on; the car starts 2 m before the start line, and rests within 100 m past
/// the finish.
[[nodiscard]] RaceCourse acceleration_course();

/// Skidpad by the rules: two circles of 15.25 m and 21.25 m inner and outer diameter, centres 18.25 m apart,
/// at (0, -9.125) and (0, 9.125); entry and exit along the x axis. The car starts 16 m before the line,
/// drives right twice and left twice, and rests within 25 m past the line.
[[nodiscard]] RaceCourse skidpad_course();

/// The geometry of acceleration or skidpad with the cones of a track of that event, whose frame must be as
/// above. The lane of an acceleration is as wide as the track's boundaries say.
[[nodiscard]] RaceCourse mission_course(Mission mission, const Track& track);
[[nodiscard]] RaceCourse mission_course(Mission mission);

/// Acceleration or skidpad as an event might set it up, different for each seed: width, spacing, gates, entry
/// and exit vary as the rules allow; cones are some decimetres off their places, some are missing, and some
/// do not belong to the course. The frame is as above, the start within 1.5 m of the start of the rules. The
/// big cones of an acceleration's finish are always present.
[[nodiscard]] RaceCourse varied_mission_course(Mission mission, std::uint64_t seed);

/// The foot of a car on the true line, followed from step to step, so that other stretches of the line at the
/// same distance do not count. The course must outlive it.
class CourseFoot {
  public:
    CourseFoot(const RaceCourse& course, double at_m) : course_(course), at_m_(at_m) {}

    /// Moves by at most `reach_m`, forward or backward.
    void follow(const Point& point, double reach_m = 3.0);

    /// Arc length with completed rounds. A step counts as step_m, also a shorter last step of a round.
    [[nodiscard]] double at_m() const { return at_m_; }
    [[nodiscard]] double distance_m() const { return distance_m_; }
    [[nodiscard]] double round_m() const { return static_cast<double>(course_.line.size()) * course_.step_m; }
    /// The point of the line with this number; nothing where a line that is driven once has none.
    [[nodiscard]] std::optional<Point> place(long number) const;

  private:
    const RaceCourse& course_;
    double at_m_;
    double distance_m_ = 0.0;
};

/// Whether the segment between two points stays inside the lane of a circuit: it crosses no boundary between
/// neighbouring cones, and ends in the ring between the boundaries.
[[nodiscard]] bool stays_in_ring(const TrackBoundaries& lane, const Segment& way);

/// Whether the first metres of a path leave the lane. `at`: the car's position.
[[nodiscard]] bool leaves(const RaceCourse& course, const std::vector<Point>& path, double up_to_m,
                          CourseFoot at);

}  // namespace conelane::experiments
