#pragma once

#include "conelane/invalid_input.hpp"
#include "evaluation/files/input_error.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace conelane {

/// The whole file. Throws InputError naming it if it cannot be read.
[[nodiscard]] inline std::string text_of(const std::filesystem::path& file) {
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

}  // namespace conelane
