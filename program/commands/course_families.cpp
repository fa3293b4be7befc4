#include "program/commands/course_families.hpp"

#include <algorithm>
#include <cstddef>

#include <CLI/CLI.hpp>

namespace conelane::experiments {

std::vector<CourseFamily> parse_families(const std::vector<std::string>& texts) {
    std::vector<CourseFamily> families;
    for (const std::string& text : texts) {
        const std::size_t equals = text.find('=');
        const std::string name = text.substr(0, equals);
        const bool is_name = !name.empty() && std::ranges::all_of(name, [](char letter) {
            return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
                   (letter >= '0' && letter <= '9') || letter == '_' || letter == '-';
        });
        if (equals == std::string::npos || !is_name) {
            throw CLI::ValidationError(
                "--family", "'" + text + "' is not NAME=SPEC with a name of letters, digits, _ and -");
        }
        auto family = std::ranges::find(families, name, &CourseFamily::name);
        if (family == families.end()) family = families.insert(families.end(), {name, {}});
        family->tracks.push_back(text.substr(equals + 1));
    }
    return families;
}

}  // namespace conelane::experiments
