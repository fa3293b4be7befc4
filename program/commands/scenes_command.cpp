#include "evaluation/formats/scene_file.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "evaluation/formats/track_spec.hpp"
#include "evaluation/progress/progress.hpp"
#include "program/commands/commands.hpp"

namespace conelane::program {
namespace {

struct ScenesOptions {
    ScenesOptions() {
        scenes.false_positive_rates = {0.0};
        scenes.ranges_m = {30.0};
    }
    std::vector<std::string> tracks;
    SceneOptions scenes;
    std::string out;
};

void make_scenes(const ScenesOptions& options) {
    LeftOutScenes left_out;
    std::optional<Progress> progress;
    const SceneSet set =
        make_scene_set(options.tracks, options.scenes, {}, left_out, [&](std::size_t, std::size_t total) {
            if (progress)
                progress->advance();
            else
                progress.emplace("scenes", total);
        });
    progress.reset();
    write_scene_set(options.out, set, left_out);
    if (!left_out.empty()) fmt::print(stderr, "conelane: {}\n", note_on(left_out));
    fmt::print("{} scenes of {} tracks in {}, boundaries in {}\n", set.scenes.size(), set.tracks.size(),
               options.out, track_boundaries_path(options.out).string());
}

}  // namespace

void add_scenes_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand("scenes", "scenes from tracks, with their ground truth");
    command.footer(track_format_lines());
    auto options = std::make_shared<ScenesOptions>();
    add_tracks_option(command, options->tracks)->required();
    add_scene_options(command, options->scenes);
    add_nearest_option(command, options->scenes.nearest, "keep only the N nearest cones ahead");
    add_threads_option(command, options->scenes.threads, "number of threads; the scenes do not depend on it");
    add_output_option(command, "--out", options->out, "NAME.scenes.jsonl; NAME.tracks.json goes beside it")
        ->required();
    command.callback([options] { make_scenes(*options); });
}

}  // namespace conelane::program
