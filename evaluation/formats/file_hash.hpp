#pragma once

#include <filesystem>
#include <string>

namespace conelane {

/// FNV-1a of a file's bytes, 16 hexadecimal digits; empty if it cannot be read.
[[nodiscard]] std::string file_hash(const std::filesystem::path& file);

}  // namespace conelane
