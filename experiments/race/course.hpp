#pragma once

#include "conelane/planner.hpp"
#include "evaluation/world/track.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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
    double rest_m = 0.0;                        ///< behind the finish: the car must be at rest there
    std::vector<std::string_view> phases = {};  ///< phases that a planner must report, in order
};

/// A closed course with annotated boundaries, starting at its first left cone. Throws InvalidInput if the
/// track is not closed, and like centre_line_poses.
[[nodiscard]] RaceCourse circuit(const Track& track);

/// Acceleration by the rules: a straight lane 3.8 m wide, cones every 5 m, big cones at the start line at
/// x = 0 and at the finish 75 m on; the car starts 2 m before the start line, and rests within 100 m behind
/// the finish.
[[nodiscard]] RaceCourse acceleration_course();

/// Skidpad by the rules: two circles of 15.25 m and 21.25 m inner and outer diameter, centres 18.25 m apart,
/// at (0, -9.125) and (0, 9.125); entry and exit along the x axis. The car starts 16 m before the line,
/// drives right twice and left twice, and rests within 25 m behind the line.
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

}  // namespace conelane::experiments
