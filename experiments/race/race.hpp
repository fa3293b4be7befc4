#pragma once

#include "conelane/speed_profile.hpp"
#include "experiments/race/world.hpp"

#include <functional>

namespace conelane::experiments {

/// Faults of the transmission of frames from the world to the method.
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
/// Throws InvalidInput if there is none of that name.
[[nodiscard]] RaceFault race_fault(std::string_view name);

struct RaceOptions {
    SightOptions sight;
    int laps = 1;  ///< of a circuit
    double speed_mps = 6.0;
    /// As fast as the path and its trusted length allow, instead of speed_mps; from a standstill.
    bool by_safe = false;
    bool with_slip = false;  ///< drives a DynamicCar instead of a Vehicle
    VehicleLimits limits = {};
    double latency_s = 0.05;  ///< from a frame to its path; simulated, so that a race can be repeated
    /// True: it starts at rest and has to stop by itself. False: it rolls; the last lap ends the race.
    bool with_stop = false;
    double start_error_m = 0.0;    ///< the car starts within this distance of the start
    double start_error_rad = 0.0;  ///< and of its direction
    bool with_any_map = false;     ///< the map frame is random; otherwise it is that of the course
    double drift_m = 0.0;          ///< of the map in a lap, or along the whole way if there are no laps
    double drift_rad = 0.0;
    RaceFault fault = RaceFault::none;
    bool keep_replay = false;
};

/// The answer to a frame.
struct Drive {
    std::vector<Point> path;  ///< from the car on, in the map frame; fewer than two points: none
    bool stop = false;
    /// Whether the path is said to be an earlier one, or absent.
    bool is_flagged = false;
    double age_s = 0.0;                                       ///< age of the frame that the path belongs to
    double safe_m = std::numeric_limits<double>::infinity();  ///< along the path: how far it is trusted
    std::string_view state;                                   ///< of a planner, else empty
    std::string_view phase;
    int lap = 0;
    bool brake = false;       ///< brake, because the way is lost
    bool is_refused = false;  ///< the frame was not accepted; the car keeps its path
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
    stopped_early,  ///< the planner said stop before the line
    not_stopped,    ///< not at rest within the allowed distance
    halted,         ///< at rest on the way for 5 s: lost, or without a first path
    wrong_phases,   ///< at rest in time, but the reported phases are not those of the mission
    too_long,       ///< longer than 2.5 times the time of a perfect race
};
[[nodiscard]] std::string_view to_string(RaceEnd end);

/// The first lap of a race, or the others.
struct LapFigures {
    int laps = 0;         ///< that were completed
    double time_s = 0.0;  ///< of those
    /// Time of one lap of the same car, if it knows its pose and the course; absent: not measured.
    std::optional<double> known_lap_s = {};
    int frames = 0;           ///< with a path
    int short_frames = 0;     ///< trusted for less than 3 m, also those without a path
    int wrong_trusted = 0;    ///< frames whose path leaves the lane where it is trusted
    int right_untrusted = 0;  ///< trusted for less than 3 m, though its path is right for 10 m
    /// Of the path 5 m ahead, from the frame before; 95 of 100 are smaller.
    std::optional<double> sideways_p95_m = {};
    double max_curvature_1pm = 0.0;  ///< of the first 10 m of a path

    [[nodiscard]] std::optional<double> time_ratio() const {
        return laps > 0 && known_lap_s ? std::optional(time_s / laps / *known_lap_s) : std::nullopt;
    }
};

struct RaceResult {
    RaceEnd end = RaceEnd::too_long;
    int finished_laps = 0;
    double driven_m = 0.0;              ///< along the course, laps included
    std::optional<double> departure_m;  ///< along the course
    std::optional<double> stop_said_m;  ///< past the finish line; negative: before it
    std::optional<double> rest_m;       ///< past the finish line
    int cones_hit = 0;
    std::optional<double> lateral_error_p95_m;  ///< of the car's middle to the true centre line
    int frames = 0;                             ///< answered
    int frames_without_path = 0;
    int frames_refused = 0;
    int wrong_unflagged = 0;  ///< frames whose path leaves the lane within 10 m without being marked as old
    double time_s = 0.0;
    double old_path_s = 0.0;               ///< time driven by a path older than the last frame but one
    std::optional<double> unsteady_share;  ///< of successive paths: more than 0.3 m apart within 10 m
    std::vector<std::string_view> phases;  ///< as reported, in order
    int laps_told = 0;
    std::array<LapFigures, 2> by_lap;  ///< the first lap, and later ones

    std::vector<double> answer_ms;  ///< real time of each answer; without influence on the race
    std::vector<ReplayFrame> replay;
    std::vector<Point> false_positives;

    [[nodiscard]] bool finished() const { return end == RaceEnd::finished; }
};

/// Drives a course by the answers of a driver. The result, without `answer_ms`, depends only on the arguments
/// and the answers. Precondition: the course was made by a function of course.hpp.
[[nodiscard]] RaceResult race(const RaceCourse& course, const RaceOptions& options, const Driver& driver);

}  // namespace conelane::experiments
