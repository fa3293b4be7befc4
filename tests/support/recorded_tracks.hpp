#pragma once

#include "evaluation/formats/track_spec.hpp"
#include "tests/support/test_paths.hpp"
#include "tests/support/testing.hpp"

namespace conelane {

/// The folder in the environment variable CONELANE_DATA, else ../shared/data beside the sources, if any.
inline std::filesystem::path recorded_data() {
    const char* const given = std::getenv("CONELANE_DATA");
    if (given != nullptr) return given;
    return source_directory().parent_path() / "shared" / "data";
}

/// All recorded courses; none without the data.
inline std::vector<Track> recorded_tracks() {
    namespace fs = std::filesystem;
    const fs::path data = recorded_data();
    std::vector<std::string> specs;
    const auto add_files = [&](const char* folder, const std::string& kind, const std::string& extension) {
        if (!fs::is_directory(data / folder)) return;
        for (const fs::directory_entry& entry : fs::directory_iterator(data / folder)) {
            if (entry.path().extension() == extension) specs.push_back(kind + ":" + entry.path().string());
        }
    };
    add_files("pacsim", "pacsim", ".yaml");
    for (const char* const folder : {"eufs", "epfl", "fssim", "fsai_sim"}) add_files(folder, "eufs", ".csv");
    if (const fs::path fsd = data / "fsd_racetrack_dataset"; fs::is_directory(fsd)) {
        specs.push_back("fsd:" + fsd.string());
    }
    std::ranges::sort(specs);
    std::vector<Track> tracks;
    for (const std::string& spec : specs) {
        for (Track& track : load_tracks(spec)) tracks.push_back(std::move(track));
    }
    return tracks;
}

}  // namespace conelane

/// Skips the test where there are no recorded tracks.
#define CONELANE_RECORDED_TRACKS_OR_SKIP(tracks)                                    \
    const std::vector<Track> tracks = recorded_tracks();                            \
    if ((tracks).empty()) {                                                         \
        GTEST_SKIP() << "no recorded tracks in CONELANE_DATA or in ../shared/data"; \
    }                                                                               \
    static_assert(true, "a semicolon follows")
