#pragma once

#include "conelane/planner.hpp"
#include "evaluation/scenes/condition.hpp"
#include "experiments/race/course.hpp"
#include "experiments/race/world.hpp"

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace conelane::experiments {

/// What goes wrong between the world and who answers frames.
enum class RaceFault {
    none,
    jump,      ///< every 5 s the map moves by 0.5 m, all cones and the pose at once
    late,      ///< a fifth of the frames come 0.1 to 0.3 s late, and hold up those after them
    twice,     ///< a fifth of the frames come twice
    order,     ///< a fifth of the frames come 0.1 to 0.3 s late, after younger ones
    blackout,  ///< every 8 s a second without cones
    ids,       ///< every 5 s each cone gets another id
};
[[nodiscard]] std::string_view to_string(RaceFault fault);
/// Throws InvalidInput where there is none of that name.
[[nodiscard]] RaceFault race_fault(std::string_view name);

struct RaceOptions {
    SightOptions sight;
    int laps = 1;  ///< of a circuit
    double speed_mps = 6.0;
    double latency_s = 0.05;  ///< from a frame to its path; simulated, so that a race can be repeated
    /// The car starts at rest and has to stop by itself; else it rolls, and the last lap ends the race.
    bool with_stop = false;
    double start_error_m = 0.0;    ///< the car starts within this distance of the start
    double start_error_rad = 0.0;  ///< and of its direction
    bool with_any_map = false;     ///< the map frame lies anywhere; else it is that of the course
    double drift_m = 0.0;          ///< of the map in a lap (of an event that has none, along the whole way)
    double drift_rad = 0.0;
    RaceFault fault = RaceFault::none;
    bool keep_replay = false;
};

/// The answer to a frame.
struct Drive {
    std::vector<Point> path;  ///< from the car on, in the map frame; fewer than two points: none
    bool stop = false;
    /// The path is said to be an earlier one, or that there is none.
    bool is_flagged = false;
    double age_s = 0.0;                                       ///< of the frame that the path stems from
    double safe_m = std::numeric_limits<double>::infinity();  ///< of the path
    std::string_view state;                                   ///< of a planner, else empty
    std::string_view phase;
    int lap = 0;
    bool brake = false;       ///< the way is lost
    bool is_refused = false;  ///< the frame was not accepted; the path before goes on
};

using Driver = std::function<Drive(const Frame&)>;

struct ReplayFrame {
    double time_s = 0.0;
    Pose pose;                ///< true, of the rear axle
    std::vector<Point> path;  ///< in the world
    std::vector<Point> seen;  ///< in the world
    std::string_view state;
};

/// How a race ended.
enum class RaceEnd {
    finished,
    departed,       ///< the car's middle left the lane
    stopped_early,  ///< a stop was said before the line
    not_stopped,    ///< not at rest where it has to be
    halted,         ///< at rest on the way for 5 s: lost, or without a first path
    wrong_phases,   ///< at rest in time, but the phases told are not those of the mission
    too_long,       ///< 2.5 times the time of a perfect race are over
};
[[nodiscard]] std::string_view to_string(RaceEnd end);

struct RaceResult {
    RaceEnd end = RaceEnd::too_long;
    int finished_laps = 0;
    double driven_m = 0.0;              ///< along the course, laps included
    std::optional<double> departure_m;  ///< along the course
    std::optional<double> stop_said_m;  ///< behind the finish line; negative: before it
    std::optional<double> rest_m;       ///< behind the finish line
    int cones_hit = 0;
    std::optional<double> lateral_error_p95_m;  ///< of the car's middle to the true centre line
    int frames = 0;                             ///< answered
    int frames_without_path = 0;
    int frames_refused = 0;
    int wrong_unflagged = 0;  ///< frames whose path leaves the lane within 10 m and is not said to be old
    double time_s = 0.0;
    double old_path_s = 0.0;               ///< driven by a path of an earlier frame than the last but one
    std::optional<double> unsteady_share;  ///< of pairs of paths: farther than 0.3 m apart within 10 m
    std::vector<std::string_view> phases;  ///< told, in order
    int laps_told = 0;

    std::vector<double> answer_ms;  ///< real time of each answer; does not decide anything
    std::vector<ReplayFrame> replay;
    std::vector<Point> false_positives;

    [[nodiscard]] bool finished() const { return end == RaceEnd::finished; }
};

/// Answers the next 20 m of the true centre line, by the pose that the car believes; stops behind the last
/// line. It takes the map frame for that of the world: not for any map, drift or jumps.
[[nodiscard]] Driver truth_driver(const RaceCourse& course, int laps);

/// Drives a course by the answers of a driver. The result, `answer_ms` aside, depends on nothing but the
/// arguments and what the driver answers. Precondition: the course was made by a function of course.hpp.
[[nodiscard]] RaceResult race(const RaceCourse& course, const RaceOptions& options, const Driver& driver);

}  // namespace conelane::experiments
