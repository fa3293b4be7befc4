#pragma once

#include "conelane/scene.hpp"

#include <cstddef>
#include <filesystem>
#include <map>

namespace conelane {

/// A text file with a cone a line, in the order of the file.
struct ConeTable {
    std::vector<Cone> cones;         ///< ids count them
    std::vector<std::size_t> lines;  ///< of the cones
    std::optional<Pose> car_start;
    std::size_t car_start_line = 0;
    std::map<std::string, std::size_t> other_tags;  ///< number of cones whose tag is no color
    std::string guess;                              ///< what was taken for what; empty for the names of EUFS
};

/// The color that a tag or class names: "Blue", "blue_cone" and "left"; "big_orange", "orange-small".
[[nodiscard]] std::optional<ConeColor> color_named(std::string_view tag);

/// Reads columns separated by commas, semicolons, tabs or blanks. A header names them; without one, a line
/// is tag, x, y and perhaps a direction, or x, y, tag. Quotes, a byte order mark and lines that begin with #
/// are skipped. Throws InputError naming the line and the column.
[[nodiscard]] ConeTable read_cone_table(const std::filesystem::path& file);

}  // namespace conelane
