#pragma once

#include <filesystem>

namespace conelane::experiments {

/// Throws InputError where the directory holds a report.html that is no page of this program: it would be
/// lost.
void require_own_page(const std::filesystem::path& directory);

/// Says where the wide table of a comparison is.
void say_wide_table(const std::filesystem::path& directory);

/// Writes report.html beside the results of a comparison and says where all of it is. The results are whole
/// without the page, which takes Python and matplotlib: where these are missing, that is said instead. Throws
/// what else keeps the page from being made, such as a full disk.
void write_page(const std::filesystem::path& directory);

}  // namespace conelane::experiments
