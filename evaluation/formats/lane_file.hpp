#pragma once

#include "conelane/lane_detector.hpp"
#include "conelane/point.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace conelane {

/// Both boundaries of a lane as positions [m], in driving order from the car outward.
struct BoundaryPoints {
    std::vector<Point> left;
    std::vector<Point> right;
};

/// A line of a `*.lanes.jsonl` file: what a detector answered on a scene, and how fast.
struct LaneRecord {
    std::string scene;
    std::string detector;
    LaneAnswer answer;
    double latency_ms = 0.0;             ///< from the scene in memory to the lane in memory
    std::optional<std::size_t> nearest;  ///< size of the cone set the detector was given; absent: all cones
    bool checked = false;                ///< the independent checker of the RLD model accepted the lane
    std::size_t line = 0;                ///< in the file that was read; 0 without a file
    /// Boundaries as positions instead of cones. `answer.lane` then names no cone, but its `closed` is
    /// valid.
    std::optional<BoundaryPoints> points = {};
    std::vector<Point> centre_line = {};       ///< of an answer without boundaries, from the car outward
    std::optional<double> self_timed_ms = {};  ///< the time that a program from outside reports
};

/// Records in the order of the file, which may be empty. Throws InputError naming file, line and key: for
/// invalid JSON, for cones with a status other than found, and for a second answer of a detector to a scene
/// with the same cone set. If `objective` is present and `bound` is absent, the bound is minus infinity.
[[nodiscard]] std::vector<LaneRecord> read_lanes(const std::filesystem::path& file);

/// The answer of a detector from outside in one line. It is like a line of a lanes file, but `method` and
/// `latency_ms` may be absent, and so may `left` and `right` if nothing was found. What it claims about
/// optimality, enumeration and cone set is ignored. The latency becomes `self_timed_ms`. Throws InputError.
[[nodiscard]] LaneRecord read_foreign_lane(std::string_view line);
/// The same for each line of a file, which may be empty, with `latency_ms`. Throws InputError naming file,
/// line and key, also for a second answer to a scene.
[[nodiscard]] std::vector<LaneRecord> read_foreign_lanes(const std::filesystem::path& file);

/// A bound of minus infinity (nothing proven) is left out. Throws InvalidInput if another number is not
/// finite, InputError if the file cannot be written; an old file then stays unchanged.
/// LaneAnswer::solved and LaneAnswer::merged are not stored.
void write_lanes(const std::filesystem::path& file, std::span<const LaneRecord> records);

/// One record as its line, without newline. Throws InvalidInput like write_lanes.
[[nodiscard]] std::string lane_line(const LaneRecord& record);

}  // namespace conelane
