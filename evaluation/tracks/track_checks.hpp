#pragma once

#include "evaluation/tracks/track.hpp"

#include <filesystem>
#include <string>

namespace conelane {

/// The whole content of a file. Throws InputError where it cannot be read.
[[nodiscard]] std::string file_content(const std::filesystem::path& file);

/// Why `coordinate_m` cannot be that of a cone, empty where it can: it is not finite or beyond 10^7 m.
[[nodiscard]] std::string coordinate_fault(double coordinate_m);

/// Throws InputError naming `left` or `right` where a boundary has too few cones: three make a closed course,
/// two an open one.
void require_enough_cones(const Track& track, const std::filesystem::path& file);

}  // namespace conelane
