#pragma once

#include "evaluation/tracks/track.hpp"

#include <filesystem>
#include <string>

namespace conelane {

/// The whole content of a file. Throws InputError if it cannot be read.
[[nodiscard]] std::string file_content(const std::filesystem::path& file);

/// Why `coordinate_m` is invalid for a cone (not finite, or beyond 10^7 m); empty if it is valid.
[[nodiscard]] std::string coordinate_fault(double coordinate_m);

/// Throws InputError naming `left` or `right` if a boundary has too few cones: a closed course needs three,
/// an open one two.
void require_enough_cones(const Track& track, const std::filesystem::path& file);

}  // namespace conelane
