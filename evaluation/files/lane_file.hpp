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
    std::size_t line = 0;                ///< in the file that was read; 0: none was
    /// Boundaries that are positions instead of cones; then `answer.lane` names no cone, but says whether
    /// they are closed.
    std::optional<BoundaryPoints> points = {};
    std::vector<Point> centre_line = {};       ///< of an answer that has no boundaries, from the car outward
    std::optional<double> self_timed_ms = {};  ///< what a program from outside says that it took
};

/// Records in the order of the file, which may hold none. Throws InputError naming file, line and key: beside
/// what is no such JSON, where a status other than found comes with cones or a detector answers a scene twice
/// with the same cone set. An absent `bound` beside an `objective` is read as minus infinity.
[[nodiscard]] std::vector<LaneRecord> read_lanes(const std::filesystem::path& file);

/// What a detector from outside answered, in one line: as a line of a lanes file, but `method` and
/// `latency_ms` may be missing, `left` and `right` too where nothing was found; what it claims of optimality,
/// enumeration and cone set is not read. The latency becomes `self_timed_ms`. Throws InputError.
[[nodiscard]] LaneRecord read_foreign_lane(std::string_view line);
/// The same for each line of a file, which may hold none, with `latency_ms`. Throws InputError naming file,
/// line and key, so where a scene is answered twice.
[[nodiscard]] std::vector<LaneRecord> read_foreign_lanes(const std::filesystem::path& file);

/// A bound of minus infinity (nothing proven) is left out. Throws InvalidInput where another number is not
/// finite, InputError where the file cannot be written; then an old file stays as it was.
void write_lanes(const std::filesystem::path& file, std::span<const LaneRecord> records);

/// One record as its line, without newline. Throws InvalidInput like write_lanes.
[[nodiscard]] std::string lane_line(const LaneRecord& record);

}  // namespace conelane
