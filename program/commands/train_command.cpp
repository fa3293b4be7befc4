#include "evaluation/formats/file_text.hpp"
#include "evaluation/formats/track_spec.hpp"
#include "evaluation/formats/weights_file.hpp"
#include "graph_search/clc/clc_detector.hpp"
#include "learning/training/clc_training.hpp"
#include "learning/training/front_training.hpp"
#include "learning/training/rld_training.hpp"
#include "learning/training/strip_training.hpp"
#include "program/commands/command_parts.hpp"

#include <cstdio>

namespace conelane::program {
namespace {

constexpr const char* kHoldOut = "tracks to measure on only, not to learn from";

void say(const std::string& line) {
    fmt::print("{}\n", line);
    std::fflush(stdout);
}

void add_hold_out_every(CLI::App& command, double& every_m) {
    add_number_option(command, "--hold-out-every", every_m, 0.01, 1000.0,
                      "travel between poses on the tracks held out [m]");
}

struct FrontOptionsOfTraining {
    FrontTrainingRunOptions run;
    std::string from;
    std::string out;
};

void train_front_weights(FrontOptionsOfTraining options) {
    if (!options.from.empty()) {
        options.run.training.initial = read_front_weights(options.from);
        options.run.training.initial_name = file_hash(options.from);
    }
    AtomicFile output(options.out);
    const FrontTrainingRun result = run_front_training(options.run, say);
    output.stream() << front_weights_json(result.weights, result.record);
    output.commit();
}

void add_front(CLI::App& train_command) {
    CLI::App& command = *train_command.add_subcommand(
        "front", "trains the weights of front: move by move along true lanes, then through its search");
    auto options = std::make_shared<FrontOptionsOfTraining>();
    FrontTrainingRunOptions& run = options->run;
    command.add_option("--tracks", run.tracks, track_grammar())->required();
    command.add_option("--hold-out", run.hold_out, kHoldOut);
    command.add_option("--trust-tracks", run.trust_tracks,
                       "tracks to choose the threshold of trust on, not to learn from; without them it is "
                       "chosen on new draws of --tracks");
    add_hold_out_every(command, run.hold_out_every_m);
    command.add_option("--condition", run.conditions, "conditions of the held-out scenes: paper, car, harsh")
        ->delimiter(',')
        ->capture_default_str();
    command.add_option("--fp", run.rates, "share of false positives among all points of the scenes held out")
        ->delimiter(',')
        ->capture_default_str();
    command.add_option(
        "--from", options->from,
        "weights to begin with, such as those of an earlier version; drawn weights without it. "
        "The record has the hash of the file");
    add_field_options(command, option_fields(run.training));
    command
        .add_flag_callback(
            "--no-noise-scenes", [&run] { run.training.scenes.noise_share = 0.0; },
            "the judge sees no scenes of false cones alone")
        ->excludes("--noise-share");
    add_output_option(command, "--out", options->out, "weights (JSON)")->required();
    command.callback([options] { train_front_weights(*options); });
}

void add_rld(CLI::App& train_command) {
    struct Options {
        std::vector<std::string> tracks;
        std::string parameters;
        RldTrainingOptions training;
        std::string out;
    };
    CLI::App& command = *train_command.add_subcommand(
        "rld", "learns costs of the RLD program with its exact search inside: edges, turns and ends");
    auto options = std::make_shared<Options>();
    command.add_option("--tracks", options->tracks, track_grammar())->required();
    command.add_option(
        "--params", options->parameters,
        "parameters that the costs are added to, a set or a file (JSON), whose learned costs the training "
        "begins with; without it limits that allow most true lanes, and no other cost");
    add_field_options(command, option_fields(options->training));
    add_output_option(command, "--out", options->out,
                      "parameters (JSON); the costs get a file beside it, FILE.weights.json for FILE.json")
        ->required();
    command.callback([options] {
        if (!options->parameters.empty())
            options->training.parameters = ParameterSource{options->parameters, {}}.load();
        const RldTrainingRun result = run_rld_training(options->tracks, options->training, say);
        write_rld_parameters(options->out, result.parameters, result.record);
    });
}

void add_strip(CLI::App& train_command) {
    struct Options {
        std::vector<std::string> tracks;
        StripTrainingOptions training;
        std::string out;
    };
    CLI::App& command = *train_command.add_subcommand(
        "strip", "learns costs of the strip program with its exact search inside: both boundaries together");
    auto options = std::make_shared<Options>();
    command.add_option("--tracks", options->tracks, track_grammar())->required();
    add_field_options(command, option_fields(options->training));
    add_output_option(command, "--out", options->out, "costs (JSON)")->required();
    command.callback([options] {
        AtomicFile output(options->out);
        output.stream() << run_strip_training(options->tracks, options->training, say);
        output.commit();
    });
}

struct ClcTrainingOptions {
    ClcTrainingOptions() {
        run.scenes.false_positive_rates = {0.0, 0.1, 0.2, 0.3, 0.4, 0.5};
        run.scenes.ranges_m = {30.0, 50.0};
        run.scenes.every_m = 1.0;
        run.candidates.max_per_scene = 120;
    }
    TrainingRunOptions run;
    bool extended = false;
    bool steps = false;
    std::string step_scores;
    StepScoreTrainingOptions step_training;
    std::string out;
};

TrainingRun train_steps(const ClcTrainingOptions& options) {
    StepTrainingRunOptions run{options.run, options.step_training};
    run.training.search = extended_search_options();
    run.training.seed = run.scenes.seed;
    return run_step_training(run);
}

TrainingRun train_network(TrainingRunOptions run, const ClcTrainingOptions& options) {
    const std::int64_t iterations = run.candidates.search.iteration_limit;
    run.training.inputs = options.extended ? kLaneFeatureCount : kPaperFeatureCount;
    if (options.extended) {
        run.candidates.search = extended_search_options();
        run.steps_record = step_scores_training(kStepScoresFile);
        run.training.loss = RankLoss::choice;
    }
    if (!options.step_scores.empty()) {
        run.candidates.search.step_scores =
            std::make_shared<StepScores>(parsed_file(options.step_scores, [&](const std::string& text) {
                run.steps_record = step_scores_training(text);
                return parse_step_scores(text);
            }));
    }
    run.candidates.search.iteration_limit = iterations;
    run.training.seed = run.candidates.seed = run.scenes.seed;
    run.candidates.threads = run.scenes.threads;
    return run_training(run);
}

/// One of the two networks, or the step scores, which do not use `variants`.
void add_kind_options(CLI::App& command, ClcTrainingOptions& options) {
    command.add_flag("--extended", options.extended,
                     "the network of clc, on its search, by all features and the quality of its choice; "
                     "without it that of clc-paper");
    command
        .add_flag("--steps", options.steps, "train the step scores of clc's beam search instead of a network")
        ->excludes("--extended")
        ->excludes("--variants");
    command
        .add_option("--step-scores", options.step_scores,
                    "step scores (JSON) of the beam search that finds candidates, with --extended; "
                    "without it those of clc")
        ->needs("--extended")
        ->excludes("--steps");
}

}  // namespace

void add_train_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand(
        "train",
        "trains the ranking network of clc, or the step scores of its beam search; "
        "`conelane train front` trains the networks of front, `conelane train rld` the "
        "costs of RLD");
    auto options = std::make_shared<ClcTrainingOptions>();
    TrainingRunOptions& run = options->run;
    command.add_option("--tracks", run.tracks, track_grammar());
    command.add_option("--hold-out", run.hold_out, kHoldOut);
    add_scene_options(command, run.scenes);
    add_hold_out_every(command, run.hold_out_every_m);
    add_field_options(
        command, {{"--variants", "", &run.variants, kCountOrNone,
                   "number of variants of each track to train on too: stretched, every second one reversed"},
                  {"--candidates", "", &run.candidates.max_per_scene, kCountOrNone,
                   "largest number of candidates of a scene, drawn at random; 0 for all"},
                  {"--iterations", "", &run.candidates.search.iteration_limit, kCount,
                   "limit of each scene's search for candidates"}});
    add_kind_options(command, *options);
    add_field_options(command, option_fields(options->step_training));
    add_field_options(command, option_fields(run.training));
    add_threads_option(command, run.scenes.threads, "the weights are the same with any number");
    add_output_option(command, "--out", options->out, "weights (JSON)");
    add_front(command);
    add_rld(command);
    add_strip(command);
    command.callback([options, &command] {
        if (!command.get_subcommands().empty()) return;
        // Checked here: CLI11 would require an option of this command also for its sub-commands.
        for (const char* name : {"--tracks", "--out"}) {
            if (command.count(name) == 0) throw CLI::RequiredError(name);
        }
        AtomicFile output(options->out);
        const TrainingRun result =
            options->steps ? train_steps(*options) : train_network(options->run, *options);
        output.stream() << result.file;
        output.commit();
        fmt::print("{}", result.summary);
    });
}

}  // namespace conelane::program
