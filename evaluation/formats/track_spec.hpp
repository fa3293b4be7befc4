#pragma once

#include "evaluation/world/track.hpp"

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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
