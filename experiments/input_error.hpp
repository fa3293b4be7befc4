#pragma once

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace conelane::experiments {

/// Bad input in a file. what() is one line "FILE:LINE: KEY: REASON"; a line of 0 and an empty key are left
/// out.
class InputError : public std::runtime_error {
  public:
    InputError(const std::filesystem::path& file, std::size_t line, const std::string& key,
               const std::string& reason)
        : std::runtime_error(file.string() + (line > 0 ? ":" + std::to_string(line) : "") + ": " +
                             (key.empty() ? "" : key + ": ") + reason) {}
};

}  // namespace conelane::experiments
