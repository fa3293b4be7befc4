#include "experiments/commands/commands.hpp"
#include "experiments/commands/shared_options.hpp"
#include "experiments/comparison/optimality.hpp"
#include "experiments/files/scene_file.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

struct Options {
    std::string scenes;
    std::string out;
    OptimalityOptions optimality;
    ParameterSource parameters;
};

void measure(Options& options) {
    options.optimality.parameters = options.parameters.load();
    const std::vector<AnnotatedScene> scenes = read_scenes(options.scenes);
    TrackBoundariesByName tracks;
    const std::filesystem::path boundaries = track_boundaries_path(options.scenes);
    if (std::filesystem::exists(boundaries)) tracks = read_track_boundaries(boundaries);
    const std::vector<OptimalityRow> rows = optimality_rows(scenes, tracks, options.optimality);
    if (!options.out.empty()) write_optimality_rows(options.out, rows, options.optimality);
    fmt::print("{}", optimality_table(rows));
}

}  // namespace

void add_optimality_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand(
        "optimality", "CLC's best candidate and the proven optimum under the same objective");
    auto options = std::make_shared<Options>();
    OptimalityOptions& optimality = options->optimality;
    command.add_option("--scenes", options->scenes, "*.scenes.jsonl")->required();
    command.add_option("--method", optimality.method, "one that enumerates")->capture_default_str();
    add_nearest_option(command, optimality.nearest, "the N nearest cones ahead only; all without it");
    add_time_limit_option(command, optimality.time_limit_ms);
    add_threads_option(command, optimality.threads, "nothing is timed");
    add_parameter_options(command, options->parameters, "the defaults");
    add_output_option(command, "--out", options->out,
                      "write a line per scene too; the page shows DIR/optimality.jsonl of its results");
    command.callback([options] { measure(*options); });
}

}  // namespace conelane::experiments
