#include "experiments/cross_validation/cross_validation.hpp"
#include "program/commands/command_parts.hpp"

namespace conelane::program {
namespace {

struct CrossValidateOptions {
    CrossValidationOptions run;
    std::vector<std::string> families;
    std::vector<std::string> detectors;
    std::optional<std::size_t> nearest;
    std::vector<std::string> learning_conditions{"paper", "car"};
    double learning_every_m = 12.0;
    unsigned threads = 1;
    std::string folds;        ///< folder of learned files; empty: learn
    std::string colors_from;  ///< folder of files learned without colors; empty: learn everything
    std::string directory;
};

OptionFields learning_fields(LearningOptions& learning) {
    return {{"--variants", "", &learning.variants, OptionRange{0.0, 100.0},
             "number of variants of each course that networks learn from too: stretched, every second one "
             "reversed"},
            {"--evaluations", "", &learning.evaluations, OptionRange{1.0, 100'000.0},
             "number of evaluations for each set of tuned parameters"},
            {"--front-steps", "", &learning.front_steps, kPositive,
             "of the training of front, as a share of the defaults of `conelane train front`"},
            {"--rld-steps", "", &learning.rld_steps, kPositive,
             "of the trainings of rld-learned and rld-strip, as a share of those of the shipped costs"}};
}

void run(CrossValidateOptions& options) {
    CrossValidationOptions& run = options.run;
    require_in_range(learning_fields(run.learning));
    run.families = parse_families(options.families);
    for (const std::string& text : split_detectors(options.detectors))
        run.comparison.methods.push_back(parse_method(text, options.nearest));
    SceneOptions& learned = run.learning.scenes;
    learned.false_positive_rates = {0.0, 0.1, 0.3, 0.5};
    learned.ranges_m = {30.0, 50.0};
    learned.conditions = options.learning_conditions;
    learned.every_m = options.learning_every_m;
    learned.with_color = run.comparison.scenes.with_color;
    learned.color_error_rate = run.comparison.scenes.color_error_rate;
    learned.color_unknown_rate = run.comparison.scenes.color_unknown_rate;
    learned.seed = run.comparison.scenes.seed;
    learned.threads = options.threads;
    run.comparison.scenes.threads = options.threads;
    run.comparison.run.threads = options.threads;
    run.folds = options.folds;
    run.colors_from = options.colors_from;
    require_own_page(options.directory);
    finish_comparison(cross_validate(run, options.directory), options.directory);
}

}  // namespace

void add_cross_validate_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand(
        "cross-validate",
        "compares methods on courses that none of them has learned from: a fold for each family of courses");
    auto options = std::make_shared<CrossValidateOptions>();
    options->detectors = {"front", "rld-pair", "rld-shape", "clc", "clc-paper"};
    SceneOptions& scenes = options->run.comparison.scenes;
    scenes.false_positive_rates = {0.0, 0.1, 0.3, 0.5};
    scenes.ranges_m = {30.0, 50.0};
    scenes.conditions = {"paper", "car"};
    scenes.every_m = 4.4;
    command
        .add_option("--family", options->families,
                    "NAME=SPEC: courses of one place or designer, held out together; a name may come with "
                    "several SPECs")
        ->required();
    command.add_option("--always", options->run.always, "SPECs that every fold learns from");
    command.add_option("--methods", options->detectors, "see `conelane methods`, separated by commas")
        ->capture_default_str();
    add_nearest_option(command, options->nearest,
                       "the same cone-set size for every method; they learn from all cones");
    add_scene_options(command, scenes);
    command
        .add_option("--learn-condition", options->learning_conditions,
                    "conditions of the scenes to learn from")
        ->delimiter(',')
        ->capture_default_str();
    command.add_option("--learn-every", options->learning_every_m, "travel between poses to learn from [m]")
        ->capture_default_str();
    add_field_options(command, learning_fields(options->run.learning));
    CLI::Option& folds =
        *command.add_option("--folds", options->folds,
                            "FOLDER/NAME/..., as another cross-validation leaves them in OUT/folds, are the "
                            "learned files for the courses of --family NAME; nothing is learned");
    for (const char* of_learning : {"--always", "--learn-condition", "--learn-every", "--variants",
                                    "--evaluations", "--front-steps", "--rld-steps"})
        folds.excludes(of_learning);
    command
        .add_option("--colors-from", options->colors_from,
                    "FOLDER/NAME/..., learned without --color by another cross-validation: with --color, the "
                    "methods go on from there. front learns its set for colours, rld-shape its weight of "
                    "colours, rld-learned all costs; the shares of steps are those of this")
        ->excludes("--folds");
    options->run.comparison.run.limits.time_limit_ms = kRealTimeLimit_ms;
    add_time_limit_option(command, options->run.comparison.run.limits.time_limit_ms);
    add_threads_option(command, options->threads,
                       "number of threads; with more than one, latencies are disturbed");
    command
        .add_option("--out", options->directory,
                    "directory of the results; a run that was stopped there resumes")
        ->required();
    command.add_flag("--overwrite", options->run.comparison.overwrite,
                     "replace another comparison in that directory; without it, the command refuses to");
    command.callback([options] { run(*options); });
}

}  // namespace conelane::program
