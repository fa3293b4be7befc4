#pragma once

#include "conelane/planner.hpp"
#include "evaluation/tracks/track.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace conelane::experiments {

/// Where a race is driven. Positions are true ones, in the frame of the course.
struct RaceCourse {
    std::string name;
    std::vector<Cone> cones;  ///< with their true colors
    std::vector<Pose> line;   ///< the true centre line from the start to the end, one pose every step_m
    bool closed = false;      ///< the line comes round; else it is driven once
    double step_m = 0.25;
    double length_m = 0.0;  ///< of the line, once around where it is closed
    TrackBoundaries lane;   ///< what must not be left; empty where `half_width_m` says it
    /// The lane is all that is at most this far from the line; where lines cross, from the stretch being
    /// driven.
    std::optional<double> half_width_m;
    Mission mission = Mission::trackdrive;
    double start_m = 0.0;                       ///< along the line: where the car is put
    std::optional<double> finish_m = {};        ///< along the line of a course that is not closed
    double rest_m = 0.0;                        ///< behind the finish: the car has come to rest
    std::vector<std::string_view> phases = {};  ///< that a planner tells, in order
};

/// A closed course with annotated boundaries, from where its first left cone stands. Throws InvalidInput
/// where the track is not closed, and as centre_line_poses.
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

/// Acceleration or skidpad as an event might set it up, another one for each seed: width, spacing, gates,
/// entry and exit as the rules leave room, cones some decimetres off their place, missing ones, and some
/// that are no part of the course. The frame is as above, the start within 1.5 m of that of the rules. The
/// big cones of an acceleration's finish are always there.
[[nodiscard]] RaceCourse varied_mission_course(Mission mission, std::uint64_t seed);

}  // namespace conelane::experiments
