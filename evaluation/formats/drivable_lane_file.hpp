#pragma once

#include "conelane/drivable_lane.hpp"
#include "conelane/lane_detector.hpp"
#include "conelane/planner.hpp"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace conelane {

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
