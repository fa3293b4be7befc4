#pragma once

#include "conelane/invalid_input.hpp"
#include "experiments/files/input_error.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace conelane::experiments {

/// The whole file. Throws InputError naming it where it cannot be read.
[[nodiscard]] inline std::string text_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    if (!stream) throw InputError(file, 0, "", "cannot be read");
    return text.str();
}

/// `parse(text)` of the file, whose InvalidInput comes out as an InputError in that file.
template <typename Parse>
auto parsed_file(const std::filesystem::path& file, const Parse& parse) {
    try {
        return parse(text_of(file));
    } catch (const InvalidInput& error) {
        throw InputError(file, 0, "", error.what());
    }
}

}  // namespace conelane::experiments
