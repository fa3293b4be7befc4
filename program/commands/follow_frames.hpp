#pragma once

#include "conelane/drivable_lane.hpp"

#include <optional>
#include <string>

namespace conelane::experiments {

/// Whatever `drive` writes.
struct DriveOutput {
    std::string format = "json";
    std::string out;
    std::optional<std::string> detector;
    DrivableOptions drivable;
    /// The centre line as a file of the format `tum` or `ftfsd`.
    void write_csv(const DrivableLane& lane) const;
};

/// A run of frames answered by a planner.
struct FollowOptions : DriveOutput {  // `out`: "-" for standard output
    std::string frames;               ///< file; "-" for standard input
    std::string mission = "trackdrive";
    std::string weights;  ///< empty: the shipped weights
    std::optional<int> laps;
    double interval_s = 0.1;  ///< between frames without time
    double time_limit_ms = 50.0;
};

/// Writes a line for each frame (`json`), or the closed course after the last frame (`tum`, `ftfsd`). Throws
/// InvalidInput and InputError; an invalid line of a stream gets an answer with its fault.
void follow_frames(const FollowOptions& options);

}  // namespace conelane::experiments
