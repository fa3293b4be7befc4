#pragma once

#include "conelane/planner.hpp"
#include "evaluation/tracks/track.hpp"

#include <filesystem>

namespace conelane {

class JsonNode;

/// A run of ft-fsd: a JSON list of frames with `car_position` [x, y], `car_direction` [dx, dy] and
/// `slam_cones`, the map so far as five lists of [x, y]: unknown, yellow, blue, orange, big orange. Cones of
/// two frames are one cone of the track where they are the nearest within 0.8 m; cones that a frame lacks
/// keep their last place.
///
/// Where the last map holds blue and yellow cones, its colored cones within 6.5 m of the driven path on
/// their side of it are the boundaries, in the order in which the car passes them; orange ones are of the
/// side that they are on. A run that comes back to its start is a closed course, driven more than once maybe.
/// Where such boundaries or the path cross, or a side is too short, and where there are no colors, the track
/// has no boundaries but `driven`: the path up to where it runs over a cone of the last map (within 0.5 m of
/// the car's middle), since what follows says nothing of a lane.
///
/// Throws InputError naming file and key where it is no such list, is empty or never has a cone.
[[nodiscard]] Track read_run_log(const std::filesystem::path& file);

/// One moment of such a run as the frame of a planner: the pose and the map, without ids and at time 0. It
/// may have no cone. Throws InputError naming the key.
[[nodiscard]] Frame read_run_frame(const JsonNode& json);

}  // namespace conelane
