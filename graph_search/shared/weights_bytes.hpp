#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace conelane {

/// The content of a file of weights, at most 64 MB. Throws InvalidInput("weights") if it cannot be read.
[[nodiscard]] std::string weights_bytes(const std::filesystem::path& file);

/// Calls `parse` with the content of the file. An InvalidInput of reading or parsing names the file too.
void with_weights_file(const std::filesystem::path& file, const std::function<void(std::string_view)>& parse);

}  // namespace conelane
