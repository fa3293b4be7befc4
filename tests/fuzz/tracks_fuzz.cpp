// The track readers: the bytes as each format. The line `---` separates the files of an FSD track.

#include "evaluation/formats/track_spec.hpp"
#include "tests/fuzz/expectations.hpp"
#include "tests/fuzz/scratch_folder.hpp"

namespace conelane::fuzz {
namespace {

void require_consistent(const Track& track) {
    for (const Cone& cone : track.cones) require(cone.position.allFinite(), "a cone is finite");
    for (const std::vector<std::size_t>* boundary : {&track.left, &track.right}) {
        for (const std::size_t index : *boundary)
            require(index < track.cones.size(), "a boundary is made of cones");
        std::vector<std::size_t> sorted = *boundary;
        std::ranges::sort(sorted);
        require(std::ranges::adjacent_find(sorted) == sorted.end(), "a boundary has a cone once");
    }
    for (const RunFrame& frame : track.frames) {
        require(frame.pose.position.allFinite(), "a pose is finite");
        for (const MapPlace& place : frame.map)
            require(place.cone < track.cones.size() && place.position.allFinite(), "a map is of cones");
    }
}

void read_all(std::string_view bytes) {
    static const ScratchFolder folder;
    constexpr std::string_view kParting = "\n---\n";
    const std::size_t parting = bytes.find(kParting);
    if (parting == std::string_view::npos) {
        const auto file = folder.write("track", bytes);
        for (const TrackFormat* format : track_formats()) {
            if (format->read != nullptr) answers([&] { require_consistent(format->read(file)); });
        }
    } else {
        (void)folder.write("cone_map_1.yaml", bytes.substr(0, parting + 1));
        (void)folder.write("boundaries_1.yaml", bytes.substr(parting + kParting.size()));
        answers([&] { require_consistent(read_fsd_track(folder.path(), 1)); });
    }
}

}  // namespace
}  // namespace conelane::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    conelane::fuzz::read_all({reinterpret_cast<const char*>(data), size});
    return 0;
}
