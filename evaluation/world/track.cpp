#include "evaluation/world/track.hpp"

#include "evaluation/input_error.hpp"

#include <utility>

#include <fmt/core.h>

namespace conelane {

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

Track without_doubled_cones(Track track, const std::vector<std::size_t>& repeated) {
    std::vector<bool> doubled(track.cones.size(), false);
    for (const std::size_t index : repeated) doubled[index] = true;
    const auto drop_doubled = [&](std::vector<std::size_t>& boundary) {
        std::vector<std::size_t> kept;
        for (const std::size_t index : boundary) {
            const Point& position = track.cones[index].position;
            for (const std::size_t earlier : kept) {
                if ((track.cones[earlier].position - position).norm() <= kDoubledTrackCone_m) {
                    doubled[index] = true;
                    break;
                }
            }
            if (!doubled[index]) kept.push_back(index);
        }
        boundary = std::move(kept);
    };
    drop_doubled(track.left);
    drop_doubled(track.right);

    std::vector<std::size_t> new_index(track.cones.size(), 0);
    std::vector<Cone> cones;
    for (std::size_t index = 0; index < track.cones.size(); ++index) {
        new_index[index] = cones.size();
        if (!doubled[index]) cones.push_back(track.cones[index]);
    }
    track.cones = std::move(cones);
    for (RunFrame& frame : track.frames) {
        std::erase_if(frame.map, [&](const MapPlace& place) { return doubled[place.cone]; });
        for (MapPlace& place : frame.map) place.cone = new_index[place.cone];
    }
    for (std::size_t& index : track.left) index = new_index[index];
    for (std::size_t& index : track.right) index = new_index[index];
    return track;
}

}  // namespace conelane
