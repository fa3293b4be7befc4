#include "evaluation/tracks/track_checks.hpp"

#include "evaluation/files/input_error.hpp"

#include <cmath>
#include <fstream>
#include <sstream>

#include <fmt/core.h>

namespace conelane {

std::string file_content(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) throw InputError(file, 0, "", "no such file");
    if (std::filesystem::is_directory(file, ignored)) throw InputError(file, 0, "", "is a directory");
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream content;
    content << stream.rdbuf();
    if (!stream) throw InputError(file, 0, "", "cannot be read");
    return content.str();
}

std::string coordinate_fault(double coordinate_m) {
    constexpr double kMaxCoordinate_m = 1e7;  // a map in UTM coordinates fits
    if (!std::isfinite(coordinate_m)) return "is not finite";
    if (std::abs(coordinate_m) > kMaxCoordinate_m) return "is beyond 10^7 m";
    return "";
}

void require_enough_cones(const Track& track, const std::filesystem::path& file) {
    const std::size_t fewest = track.closed ? 3 : 2;
    const auto require = [&](const std::vector<std::size_t>& boundary, const char* key) {
        if (boundary.size() >= fewest) return;
        throw InputError(file, 0, key,
                         fmt::format("{} cones, but {} course needs at least {} on each side",
                                     boundary.size(), track.closed ? "a closed" : "an open", fewest));
    };
    require(track.left, "left");
    require(track.right, "right");
}

}  // namespace conelane
