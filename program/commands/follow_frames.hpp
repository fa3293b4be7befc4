#pragma once

#include "conelane/drivable_lane.hpp"

#include <optional>
#include <string>

namespace conelane::experiments {

/// A run of frames answered by a planner.
struct FollowOptions {
    std::string frames;  ///< file; "-" for standard input
    std::string mission = "trackdrive";
    std::string detector = "front-warm";
    std::string weights;  ///< empty: the shipped weights
    std::optional<int> laps;
    double interval_s = 0.1;  ///< between frames without time
    double time_limit_ms = 50.0;
    std::string format = "json";
    std::string out;  ///< "-" for standard output
    DrivableOptions drivable;
};

/// Writes a line for each frame (`json`), or the closed course after the last frame (`tum`, `ftfsd`). Throws
/// InvalidInput and InputError; an invalid line of a stream gets an answer with its fault.
void follow_frames(const FollowOptions& options);

}  // namespace conelane::experiments
