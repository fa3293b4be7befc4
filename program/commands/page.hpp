#pragma once

#include <filesystem>

namespace conelane::experiments {

/// Throws InputError if the directory holds a report.html that is not a page of this program, which would
/// be overwritten.
void require_own_page(const std::filesystem::path& directory);

/// Prints where the wide table of a comparison is.
void say_wide_table(const std::filesystem::path& directory);

/// Writes report.html beside the results of a comparison and prints where they are. The page needs Python and
/// matplotlib: if they are missing, it says so, and the results are complete without the page. Throws if
/// another failure prevents the page, such as a full disk.
void write_page(const std::filesystem::path& directory);

}  // namespace conelane::experiments
