#pragma once

#include "conelane/planner.hpp"
#include "evaluation/world/track.hpp"

#include <filesystem>

namespace conelane {

class JsonNode;

/// A run of ft-fsd: a JSON list of frames with `car_position` [x, y], `car_direction` [dx, dy] and
/// `slam_cones`, the map so far as five lists of [x, y]: unknown, yellow, blue, orange, big orange. Cones of
/// two frames are one cone of the track if they are nearest to each other within 0.8 m; cones missing in a
/// frame keep their last place.
///
/// If the last map has blue and yellow cones, its colored cones within 6.5 m of the driven path, on their
/// side of it, are the boundaries, in the order in which the car passes them; orange cones belong to the side
/// that they are on. A run that comes back to its start is a closed course, possibly driven more than once.
/// If such boundaries or the path cross, a side is too short, or there are no colors, the track has only
/// `driven`: the path up to where it hits a cone of the last map (within 0.5 m of the car's middle), since
/// the rest does not show a lane.
///
/// Throws InputError naming file and key if it is not such a list, is empty or never has a cone.
[[nodiscard]] Track read_run_log(const std::filesystem::path& file);

/// A run of frames (read_frames) without any label, up to the first reset: the lane is what the car drove
/// through. Cones of two frames are one cone as above, at its mean place. The boundaries are the cones that
/// five frames have seen and that stay most evenly beside the driven path, 0.8 to 6.5 m from it; all others
/// belong to none. Colors count for nothing. Throws InputError naming the file if they bound no lane, and
/// naming the line of a coordinate beyond 10^7 m.
[[nodiscard]] Track read_driven_run(const std::filesystem::path& file);

/// One moment of a run of ft-fsd as the frame of a planner: the pose and the map, without ids and at time 0.
/// It may have no cone. Throws InputError naming the key.
[[nodiscard]] Frame read_run_frame(const JsonNode& json);

}  // namespace conelane
