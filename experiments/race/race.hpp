#pragma once

#include "conelane/planner.hpp"
#include "evaluation/scenes/condition.hpp"
#include "evaluation/tracks/track.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace conelane::experiments {

struct RaceOptions {
    Condition condition;
    double false_positive_rate = 0.0;  ///< in [0, 0.99]
    double range_m = 20.0;
    int laps = 1;
    double speed_mps = 6.0;
    std::uint64_t seed = 0;
    double latency_s = 0.05;  ///< from a frame to its path; simulated, so that a race can be repeated
};

/// Answers a frame with the path to drive, from the car on; nothing where there is none.
using Entrant = std::function<std::optional<std::vector<Point>>(const Frame&)>;

/// One race; it ends with the last lap or the first departure.
struct RaceResult {
    int finished_laps = 0;
    bool finished = false;
    double driven_m = 0.0;
    std::optional<double> departure_m;  ///< driven until the car's middle left the lane
    int cones_hit = 0;
    std::optional<double> lateral_error_p95_m;  ///< of the car's middle to the true centre line
    int frames = 0;
    int frames_without_path = 0;
    double old_path_s = 0.0;               ///< driven by a path of an earlier frame than the last
    std::optional<double> unsteady_share;  ///< of pairs of paths: farther than 0.3 m apart within 10 m
};

/// The true centre line of a closed course, once around. Throws as centre_line_poses.
[[nodiscard]] std::vector<Pose> true_line(const Track& track);

/// Answers the next 20 m of the true centre line, by the pose that the car believes.
[[nodiscard]] Entrant truth_entrant(const Track& track);

/// Throws InvalidInput where the track is not closed or has no boundaries. The result depends on nothing but
/// the arguments and what the entrant answers.
[[nodiscard]] RaceResult race(const Track& track, const RaceOptions& options, const Entrant& entrant);

}  // namespace conelane::experiments
