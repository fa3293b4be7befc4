#pragma once

#include <filesystem>

namespace conelane::experiments {

/// Writes report.html beside the results of a comparison and says where all of it is. The results are whole
/// without the page, which takes Python and matplotlib: where it cannot be made, that is said, too.
void write_page(const std::filesystem::path& directory);

}  // namespace conelane::experiments
