#include "experiments/commands/commands.hpp"
#include "experiments/commands/shared_options.hpp"
#include "experiments/comparison.hpp"
#include "experiments/tracks/generated_tracks.hpp"

#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

struct Options {
    Options() {
        comparison.methods = {"rld-cbc", "clc"};
        comparison.scenes.false_positive_rates = {0.0, 0.1, 0.3, 0.5};
        comparison.scenes.ranges_m = {30.0};
        comparison.scenes.every_m = 4.4;
        comparison.run.limits.time_limit_ms = 400.0;  // as in the RLD paper
    }
    ComparisonOptions comparison;
    ParameterSource parameters;
    std::string directory;
    bool full = false;
};

void compare_all(Options& options, const CLI::App& command) {
    ComparisonOptions& comparison = options.comparison;
    if (comparison.tracks.empty()) {
        for (const std::string& name : generated_track_names())
            comparison.tracks.push_back("generated:" + name);
    }
    if (options.full) {
        if (command.count("--every") == 0) comparison.scenes.every_m = 1.1;
        if (command.count("--range") == 0) comparison.scenes.ranges_m = {30.0, 50.0};
    }
    comparison.run.method.rld_parameters = options.parameters.load();
    comparison.directory = options.directory;
    const std::vector<ScoreRow> rows = compare(comparison);
    fmt::print("{}\nall of it in {}\n", score_table(rows), options.directory);
}

}  // namespace

void add_compare_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand("compare", "methods on the same scenes, scored and tabled");
    auto options = std::make_shared<Options>();
    ComparisonOptions& comparison = options->comparison;
    command.add_option(
        "--tracks", comparison.tracks,
        "generated:NAME, fsd:DIR[:1,2], pacsim:FILE or eufs:FILE; all generated ones without it");
    command.add_option("--methods", comparison.methods, "see `conelane methods`")
        ->delimiter(',')
        ->capture_default_str();
    add_scene_options(command, comparison.scenes);
    command.add_flag("--full", options->full, "the papers' size: a pose every 1.1 m, ranges of 30 and 50 m");
    add_nearest_option(command, comparison.run.method.nearest, "the same cone-set size for every method");
    add_time_limit_option(command, comparison.run.limits.time_limit_ms);
    add_threads_option(command, comparison.run.threads, "more than one disturbs the latencies");
    add_parameter_options(command, options->parameters);
    command.add_option("--out", options->directory, "directory of the results")->required();
    command.callback([options, &command] { compare_all(*options, command); });
}

}  // namespace conelane::experiments
