#pragma once

#include "conelane/planner.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <istream>
#include <optional>
#include <string>
#include <vector>

namespace conelane {

/// A line of a file or stream of frames: a frame, a reset or a fault.
struct FrameLine {
    std::size_t number = 0;      ///< line, blank ones counted, or place in a list; from 1
    std::optional<Frame> frame;  ///< absent if the line is not a frame
    bool reset = false;          ///< {"reset": true}: another run begins
    std::string fault;           ///< what is wrong with any other line; only in a stream
};

/// The frames of a run: JSON Lines, or the JSON list of a run of ft-fsd (see read_run_log). A line is a frame
/// of conelane (`pose`, `cones`, `time_s`) or one of ft-fsd (`car_position`, `car_direction`, `slam_cones`,
/// `time_s`). A frame without `time_s` is `interval_s` later than the one before, the first one after a start
/// or a reset is at 0. A frame may have no cone; a cone may have no `id`. What `Planner::update` refuses is
/// not looked at.
/// Throws InputError naming file, line and key, and where there is no frame. Precondition: `interval_s` is
/// above 0.
[[nodiscard]] std::vector<FrameLine> read_frames(const std::filesystem::path& file, double interval_s);

/// Calls `use` with each line of a stream that is not blank, before the next one is read. An invalid line is
/// passed on with its fault.
void for_each_frame_line(std::istream& stream, double interval_s,
                         const std::function<void(const FrameLine&)>& use);

}  // namespace conelane
