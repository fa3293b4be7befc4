#pragma once

#include "conelane/invalid_input.hpp"
#include "evaluation/input_error.hpp"

#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>

namespace conelane {

/// The whole file. Throws InputError naming it if it cannot be read.
[[nodiscard]] inline std::string text_of(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) throw InputError(file, 0, "", "no such file");
    if (std::filesystem::is_directory(file, ignored)) throw InputError(file, 0, "", "is a directory");
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    if (!stream) throw InputError(file, 0, "", "cannot be read");
    return text.str();
}

/// `parse(text)` of the file; its InvalidInput is rethrown as an InputError in that file.
template <typename Parse>
auto parsed_file(const std::filesystem::path& file, const Parse& parse) {
    try {
        return parse(text_of(file));
    } catch (const InvalidInput& error) {
        throw InputError(file, 0, "", error.what());
    }
}

/// FNV-1a of the bytes, 16 hexadecimal digits.
[[nodiscard]] std::string text_hash(std::string_view text);

/// FNV-1a of a file's bytes, 16 hexadecimal digits; empty if it cannot be read.
[[nodiscard]] std::string file_hash(const std::filesystem::path& file);

/// The text as a gzip file, without a name or a time: the same text gives the same bytes with one version of
/// zlib.
[[nodiscard]] std::string gzipped(std::string_view text);

}  // namespace conelane
