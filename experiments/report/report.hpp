#pragma once

#include <filesystem>
#include <string>

namespace conelane::experiments {

/// Makes one self-contained HTML page of a directory that `compare` wrote, by the Python package in the
/// program; with `pictures`, also the main figures as PNG in that folder. `wished_python`: an interpreter
/// that has matplotlib; empty: the first found. `viewer_tracks`: tracks whose laps the viewer has, separated
/// by commas; empty: as many laps as fit. Throws PackageRefused if a file of the results is invalid,
/// std::runtime_error if Python or matplotlib is missing.
void write_report(const std::filesystem::path& results, const std::filesystem::path& page,
                  const std::filesystem::path& pictures = {}, const std::string& wished_python = "",
                  const std::string& viewer_tracks = "");

}  // namespace conelane::experiments
