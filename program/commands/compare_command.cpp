#include "evaluation/scoring/statistics.hpp"
#include "evaluation/world/generated_tracks.hpp"
#include "program/commands/command_parts.hpp"

namespace conelane::program {
namespace {

struct CompareOptions {
    ComparisonOptions comparison;
    std::vector<std::string> detectors{"rld-cbc", "rld-pair", "rld-shape", "front", "clc", "clc-paper"};
    ParameterSource parameters;
    std::string directory;
    std::optional<std::size_t> nearest;
    std::vector<std::string> sizes{"6", "8", "10", "12", "14", "16", "20", "24", "30", "40", "50", "60"};
    std::vector<std::filesystem::path> shards;
    bool is_full = false;
    bool is_by_size = false;
    bool is_merge = false;
};

void add_options(CLI::App& command, CompareOptions& options) {
    ComparisonOptions& comparison = options.comparison;
    add_tracks_option(command, comparison.tracks, "; all generated ones without it");
    command
        .add_option("--methods", options.detectors,
                    "see `conelane methods`, separated by commas; exec:NAME=COMMAND asks any program and "
                    "takes the rest of its argument; lanes:NAME=FILE scores a finished lanes file; "
                    "solver:NAME=COMMAND is RLD by any solver of MPS or LP files and takes the rest, too "
                    "(docs/from-outside.md)")
        ->capture_default_str();
    add_scene_options(command, comparison.scenes);
    comparison.run.limits.time_limit_ms = kRealTimeLimit_ms;
    add_time_limit_option(command, comparison.run.limits.time_limit_ms);
    add_threads_option(command, comparison.run.threads,
                       "number of threads; with more than one, latencies are disturbed");
    command.add_flag("--candidates", comparison.run.limits.keep_candidates,
                     "score every enumerated lane too");
    add_parameter_options(command, options.parameters, "the defaults");
    add_shard_option(command, comparison.shard,
                     "every N-th lap from the I-th on, I from 0; join them by `conelane compare --merge`");
    command
        .add_option("--out", options.directory,
                    "directory of the results; a run that was stopped there resumes")
        ->required();
    command.add_flag("--overwrite", comparison.overwrite,
                     "replace another comparison in that directory; without it, the command refuses to");
    command.add_flag("--full", options.is_full,
                     "the papers' size: a pose every 1.1 m, ranges of 30 and 50 m; with the time limit of a "
                     "car, 50 ms");
    CLI::Option& by_size = *command.add_flag(
        "--by-size", options.is_by_size,
        "each method among each of --sizes nearest cones; by default 20 % false positives, a pose "
        "every 13.2 m, condition paper, and the methods rld-cbc, rld-pair, rld-shape and clc");
    add_nearest_option(command, options.nearest, "the same cone-set size for every method");
    command.get_option("--nearest")->excludes(&by_size);
    add_sizes_option(command, options.sizes, "cone-set sizes of --by-size; `all` for all visible cones")
        ->needs(&by_size)
        ->capture_default_str();
    CLI::Option& merging = *command.add_flag("--merge", options.is_merge,
                                             "join the shards of one comparison, named in any order");
    command.add_option("shards", options.shards, "directories of all shards, for --merge")->needs(&merging);
}

/// The defaults that depend on other options.
void choose_defaults(const CLI::App& command, CompareOptions& options) {
    const auto is_given = [&](const std::string& name) { return command.count(name) > 0; };
    SceneOptions& scenes = options.comparison.scenes;
    if (options.is_full) {
        if (!is_given("--every")) scenes.every_m = 1.1;
        if (!is_given("--range")) scenes.ranges_m = {30.0, 50.0};
        if (!is_given("--time-limit")) options.comparison.run.limits.time_limit_ms = kRealTimeBudget_ms;
    }
    if (options.is_by_size) {
        if (!is_given("--methods")) options.detectors = {"rld-cbc", "rld-pair", "rld-shape", "clc"};
        if (!is_given("--fp")) scenes.false_positive_rates = {0.2};
        if (!is_given("--every")) scenes.every_m = 13.2;
    }
    // Disturbances that are given one by one form a condition of their own.
    const bool is_disturbed =
        is_given("--noise") || is_given("--pose-noise") || is_given("--miss") || is_given("--persist");
    if ((is_disturbed || options.is_by_size) && !is_given("--condition")) scenes.conditions.clear();
}

void compare_and_print(CompareOptions& options) {
    ComparisonOptions& comparison = options.comparison;
    if (comparison.tracks.empty()) {
        for (const std::string& name : generated_track_names())
            comparison.tracks.push_back("generated:" + name);
    }
    const bool any_rld = std::ranges::any_of(comparison.methods, &Method::is_rld);
    if (!any_rld) options.parameters.require_not_given("these methods have");
    options.parameters.apply_to(comparison.run.detector);
    comparison.scenes.threads = comparison.run.threads;
    const bool is_whole = comparison.shard.count == 1;  // merge makes the page of all shards
    if (is_whole) require_own_page(options.directory);
    finish_comparison(compare(comparison, options.directory), options.directory, is_whole);
}

}  // namespace

void add_compare_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand("compare", "methods on the same scenes, scored and tabled");
    auto options = std::make_shared<CompareOptions>();
    SceneOptions& scenes = options->comparison.scenes;
    scenes.false_positive_rates = {0.0, 0.1, 0.3, 0.5};
    scenes.ranges_m = {30.0};
    scenes.every_m = 22.0;
    scenes.conditions = {"paper", "car"};
    add_options(command, *options);
    command.callback([options, &command] {
        if (options->is_merge) {
            if (options->shards.empty()) throw CLI::RequiredError("shards");
            require_own_page(options->directory);
            return finish_comparison(
                merge(options->shards, options->directory, options->comparison.overwrite),
                options->directory);
        }
        choose_defaults(command, *options);
        std::vector<std::optional<std::size_t>> sizes{options->nearest};
        if (options->is_by_size) sizes = cone_set_sizes("--sizes", options->sizes);
        for (const std::string& detector : split_detectors(options->detectors)) {
            for (const std::optional<std::size_t>& size : sizes)
                options->comparison.methods.push_back(parse_method(detector, size));
        }
        compare_and_print(*options);
    });
}

}  // namespace conelane::program
