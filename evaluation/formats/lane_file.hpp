#pragma once

#include "conelane/planner.hpp"

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

/// A line of JSON: the centre line of what a detector answered on a scene.
struct DrivableRecord {
    std::string scene;
    std::string detector;
    LaneStatus status = LaneStatus::found;
    DrivableLane lane;
};

/// One JSON object a line, with all members of a DrivableLane; without points if it has none. `inferred`,
/// "left" or "right", is present if that boundary is inferred. Throws InputError if the file cannot be
/// written; an old file then stays unchanged. The other writers do the same.
void write_drivable_lanes(const std::filesystem::path& file, std::span<const DrivableRecord> records);

/// CSV as in the TUM racetrack database: a comment `# x_m,y_m,w_tr_right_m,w_tr_left_m`, then a point a line.
/// The last point of a closed lane is followed by the first one, which is not repeated.
void write_tum_csv(const std::filesystem::path& file, const DrivableLane& lane);

/// CSV of the M x 4 array that ft-fsd-path-planning returns: a comment `# s_m,x_m,y_m,curvature_1pm`, then
/// one point a line.
void write_ft_fsd_csv(const std::filesystem::path& file, const DrivableLane& lane);

/// A plan as a line of JSON, without newline: `frame` is its line number in the input.
[[nodiscard]] std::string plan_line(std::size_t frame, double time_s, const Plan& plan);

/// The line for a frame that was refused.
[[nodiscard]] std::string refused_frame_line(std::size_t frame, const std::string& message);

}  // namespace conelane
