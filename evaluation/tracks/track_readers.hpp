#pragma once

#include "evaluation/tracks/track.hpp"

#include <filesystem>

namespace conelane {

/// Two cones of one boundary at most this far apart [m] count as one.
inline constexpr double kDoubledTrackCone_m = 0.3;

/// The track without the cones that lie within kDoubledTrackCone_m of an earlier cone of the same boundary:
/// the later one leaves the boundary and the map.
[[nodiscard]] Track without_doubled_cones(Track track);

// All readers return the track without doubled cones, and throw InputError where a file is missing, is not
// what its format says, holds a number that is not finite or beyond 10^7 m, or has a boundary of fewer than
// three cones (two on an open track).

/// Track `number` of a folder of the FSD racetrack dataset: `cone_map_N.yaml` (id -> [x, y]) and
/// `boundaries_N.yaml` (ids of `left:` and `right:` in driving order). A closed course; a last id that
/// repeats the first is dropped. Colors are unknown. An id twice, or one without a cone, is an error.
[[nodiscard]] Track read_fsd_track(const std::filesystem::path& directory, int number);

/// A PacSim track. Cones of `unknown:` stay in the map as cones of no boundary; `time_keeping:` holds no
/// cones. `lanesFirstWithLastConnected` says whether the course is closed. Ids count from 0: left, right,
/// unknown.
[[nodiscard]] Track read_pacsim_track(const std::filesystem::path& file);

/// An EUFS track: unordered cones of one course, blue ones left and yellow ones right of the driving
/// direction. Each boundary becomes the shortest tour of its cones that starts at the cone nearest ahead of
/// `car_start`; without one, at the first left cone of the file and the right one nearest to it. Where
/// neither color can close without an edge that stands out and turns back, the course is open: each boundary
/// becomes the shortest path of its cones, from end to end. Orange cones join the boundary they are nearer
/// to, but those beside a cone of its line none; nor do cones of any other tag, which a warning counts,
/// except `unknown`. Ids count the cones in file order. Colors of a closed course that do not bound a ring,
/// or that contradict the direction of `car_start`, are an error.
[[nodiscard]] Track read_eufs_track(const std::filesystem::path& file);

}  // namespace conelane
