#pragma once

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace conelane {

/// Bad input in a file: what() is one line "FILE:LINE: KEY: REASON", without absent parts.
class InputError : public std::runtime_error {
  public:
    /// `line` counts from 1; 0 for no line.
    InputError(const std::filesystem::path& file, std::size_t line, const std::string& key,
               const std::string& reason)
        : std::runtime_error(message(file, line, key, reason)) {}

  private:
    static std::string message(const std::filesystem::path& file, std::size_t line, const std::string& key,
                               const std::string& reason) {
        std::string text = file.string();
        if (line > 0) text += (text.empty() ? "line " : ":") + std::to_string(line);
        if (!text.empty()) text += ": ";
        if (!key.empty()) text += key + ": ";
        return text + reason;
    }
};

}  // namespace conelane
