#pragma once

#include "evaluation/world/track.hpp"

#include <string>
#include <vector>

namespace conelane {

/// The tracks that a SPEC of the command line names, without doubled cones:
/// - `generated:NAME[@SEED][,NAME[@SEED]...]`, seed 0 unless given;
/// - `fsd:DIR`, all numbers found there in ascending order, or `fsd:DIR:1,2`;
/// - `pacsim:FILE`, `eufs:FILE` and `ftlog:FILE`, or a folder in place of the file: all its files of that
/// type (.yaml, .csv and .json), by name.
/// Throws InputError, with the SPEC as key if no file is at fault.
[[nodiscard]] std::vector<Track> load_tracks(const std::string& spec);

/// The same, and prints their warnings, a line each, on standard error.
[[nodiscard]] std::vector<Track> load_tracks_aloud(const std::string& spec);

}  // namespace conelane
