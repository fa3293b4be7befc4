#include <algorithm>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "experiments/commands/commands.hpp"
#include "experiments/commands/shared_options.hpp"
#include "experiments/input_error.hpp"
#include "experiments/scene_file.hpp"
#include "experiments/track_spec.hpp"

namespace conelane::experiments {
namespace {

struct Options {
    std::vector<std::string> tracks;
    SceneOptions scenes{.false_positive_rates = {0.0}, .ranges_m = {30.0}};
    std::string out;
};

void make_scenes(const Options& options) {
    validate(options.scenes);
    std::vector<AnnotatedScene> scenes;
    TrackBoundariesByName tracks;
    for (const std::string& spec : options.tracks) {
        for (const Track& track : load_tracks(spec)) {
            if (!tracks.emplace(track.name, boundaries(track)).second) {
                throw InputError("", 0, "--tracks", "track '" + track.name + "' is named twice");
            }
            std::ranges::move(generate_scenes(track, options.scenes), std::back_inserter(scenes));
        }
    }
    if (scenes.empty()) throw InputError("", 0, "--tracks", "no pose sees two cones of both boundaries");
    write_track_boundaries(track_boundaries_path(options.out), tracks);
    write_scenes(options.out, scenes);
    fmt::print("{} scenes of {} tracks in {}, boundaries in {}\n", scenes.size(), tracks.size(), options.out,
               track_boundaries_path(options.out).string());
}

}  // namespace

void add_scenes_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand("scenes", "scenes from tracks, with their ground truth");
    auto options = std::make_shared<Options>();
    command.add_option("--tracks", options->tracks, "generated:NAME, fsd:DIR[:1,2], pacsim:FILE or eufs:FILE")
        ->required();
    add_scene_options(command, options->scenes);
    add_nearest_option(command, options->scenes.nearest, "keep the N nearest cones ahead only");
    add_threads_option(command, options->scenes.threads, "same scenes with any number");
    command.add_option("--out", options->out, "NAME.scenes.jsonl; NAME.tracks.json goes beside it")->required();
    command.callback([options] { make_scenes(*options); });
}

}  // namespace conelane::experiments
