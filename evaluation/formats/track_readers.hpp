#pragma once

#include "evaluation/formats/track_spec.hpp"

#include <filesystem>

namespace conelane {

// All readers return the track without doubled cones. They throw InputError if a file is missing, has another
// format, holds a number that is not finite or beyond 10^7 m, or has a boundary of fewer than three cones
// (two on an open track).

/// Track `number` of a folder of the FSD racetrack dataset: `cone_map_N.yaml` (id -> [x, y]) and
/// `boundaries_N.yaml` (ids of `left:` and `right:` in driving order). A closed course; a last id that
/// repeats the first is dropped. Colors are unknown. An id twice, or one without a cone, is an error.
[[nodiscard]] Track read_fsd_track(const std::filesystem::path& directory, int number);

/// A PacSim track. Cones of `unknown:` stay in the map as cones of no boundary; `time_keeping:` holds no
/// cones. `lanesFirstWithLastConnected` says whether the course is closed. Ids count from 0: left, right,
/// unknown.
[[nodiscard]] Track read_pacsim_track(const std::filesystem::path& file);

/// An EUFS track, or another course that read_cone_table reads: unordered cones, blue ones left and yellow
/// ones right of the driving direction. Cones that cannot belong to their boundary stay in the map as cones
/// of no boundary, and a warning names them. Each boundary becomes the shortest tour of its cones that starts
/// at the cone nearest ahead of `car_start`; without one, at the first left cone of the file and the right
/// one nearest to it. If neither color can close without an unusually long edge that turns back, the course
/// is open: each boundary becomes the shortest path of its cones, from end to end. Orange cones join the
/// nearer boundary, except those beside a cone of its line; cones of other tags join none, and a warning
/// counts them, except `unknown`. Ids count the cones in file order. It is an error if the colors of a closed
/// course do not bound a ring, or contradict the direction of `car_start`.
[[nodiscard]] Track read_eufs_track(const std::filesystem::path& file);

// The sources of --tracks whose files are read here and in run_log.hpp.
extern const TrackFormat kPacsimTracks;
extern const TrackFormat kEufsTracks;
extern const TrackFormat kRunTracks;
extern const TrackFormat kDrivenRuns;

}  // namespace conelane
