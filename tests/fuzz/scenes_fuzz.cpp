// Readers of scenes: a file, a stream, and the boundaries of a file's tracks. A text that is read can be
// written and read again.

#include "evaluation/formats/scene_file.hpp"
#include "tests/fuzz/expectations.hpp"
#include "tests/fuzz/scratch_folder.hpp"

#include <sstream>

namespace conelane::fuzz {
namespace {

void require_written_and_read_again(const std::vector<AnnotatedScene>& scenes, const ScratchFolder& folder) {
    const auto file = folder.path() / "again.scenes.jsonl";
    write_scenes(file, scenes);
    const std::vector<AnnotatedScene> again = read_scenes(file);
    require(again.size() == scenes.size(), "every scene is written");
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        require(scene_line(again[i].scene) == scene_line(scenes[i].scene),
                "a scene is read as it was written");
    }
}

void read_all(std::string_view bytes) {
    static const ScratchFolder folder;
    const auto file = folder.write("input.scenes.jsonl", bytes);
    answers([&] {
        const std::vector<AnnotatedScene> scenes = read_scenes(file);
        require(!scenes.empty(), "a file without scenes is refused");
        for (const AnnotatedScene& scene : scenes) validate(scene.scene);
        require_written_and_read_again(scenes, folder);
    });
    answers([&] {
        const auto tracks = read_track_boundaries(file);
        write_track_boundaries(folder.path() / "again.tracks.json", tracks);
        (void)read_track_boundaries(folder.path() / "again.tracks.json");
    });
    std::istringstream stream{std::string(bytes)};
    for_each_scene_line(stream, [](const SceneLine& line) {
        if (line.scene) validate(line.scene->scene);
        require(line.scene.has_value() + line.reset + !line.fault.empty() == 1,
                "a line is a scene, a reset or wrong");
    });
}

}  // namespace
}  // namespace conelane::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    conelane::fuzz::read_all({reinterpret_cast<const char*>(data), size});
    return 0;
}
