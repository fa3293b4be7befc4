#pragma once

#include "evaluation/world/track.hpp"

namespace conelane {

/// A source of courses: what WORD:WHAT of the option --tracks names. For a new source see CONTRIBUTING.md.
struct TrackFormat {
    std::string_view word;
    std::string_view what;   ///< for help, such as "FILE"
    std::string_view reads;  ///< for help: what it reads
    /// The ending of its files, each of one course. A folder in place of a file stands for all of them, by
    /// name.
    std::string_view ending = {};
    Track (*read)(const std::filesystem::path& file) = nullptr;
    /// For any other source; `spec` is for messages.
    std::vector<Track> (*load)(const std::string& spec, const std::string& what) = nullptr;
};

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

// The sources of --tracks whose files are read here and in frame_file.hpp.
extern const TrackFormat kPacsimTracks;
extern const TrackFormat kEufsTracks;
extern const TrackFormat kRunTracks;
extern const TrackFormat kDrivenRuns;

/// All sources, in the order of the help.
[[nodiscard]] std::span<const TrackFormat* const> track_formats();

/// What --tracks takes, in a line: "generated:NAME[@SEED], ... or ftlog:FILE".
[[nodiscard]] std::string track_grammar();
/// The sources as lines of a help text.
[[nodiscard]] std::string track_format_lines();

/// The tracks that a SPEC of the command line names, without doubled cones. Throws InputError, with the SPEC
/// as key if no file is at fault.
[[nodiscard]] std::vector<Track> load_tracks(const std::string& spec);

/// The same, and prints their warnings, a line each, on standard error.
[[nodiscard]] std::vector<Track> load_tracks_aloud(const std::string& spec);

}  // namespace conelane
