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
    std::string weights;  ///< empty: the shipped ones
    std::optional<int> laps;
    double interval_s = 0.1;  ///< between frames that have no time
    double time_limit_ms = 50.0;
    std::string format = "json";
    std::string out;  ///< "-" for standard output
    DrivableOptions drivable;
};

/// A line for each frame (`json`), or the closed course when all frames are answered (`tum`, `ftfsd`). Throws
/// InvalidInput and InputError; a line of a stream that is no frame is answered as such.
void follow_frames(const FollowOptions& options);

}  // namespace conelane::experiments
