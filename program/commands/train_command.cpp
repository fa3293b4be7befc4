#include "conelane/invalid_input.hpp"
#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/rank_net_file.hpp"
#include "evaluation/formats/step_score_file.hpp"
#include "evaluation/input_error.hpp"
#include "experiments/options/shared_options.hpp"
#include "experiments/options/whole_number.hpp"
#include "experiments/training/training_run.hpp"
#include "graph_search/clc/clc_detector.hpp"
#include "program/commands/commands.hpp"

#include <cstdint>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

struct Options {
    Options() {
        run.scenes.false_positive_rates = {0.0, 0.1, 0.2, 0.3, 0.4, 0.5};
        run.scenes.ranges_m = {30.0, 50.0};
        run.scenes.every_m = 1.0;
        run.candidates.max_per_scene = 120;
    }
    TrainingRunOptions run;
    bool extended = false;
    bool steps = false;
    std::string step_scores;
    std::int64_t iterations = CandidateSearchOptions{}.iteration_limit;
    StepScoreTrainingOptions step_training;
    unsigned threads = 1;
    std::string out;
};

void print(const char* of, const RankingFigures& figures) {
    if (figures.scenes == 0) return;
    fmt::print(
        "{:<9} {:>6} scenes  usable {:.2f} % of at most {:.2f} %, mean IoU {:.2f} % of at most {:.2f} %, a "
        "candidate of 98 % in {:.1f} %, critical {:.2f} % of at least {:.2f} %\n",
        of, figures.scenes, 100.0 * figures.usable_share, 100.0 * figures.most_usable_share,
        100.0 * figures.mean_iou, 100.0 * figures.mean_best_iou, 100.0 * figures.near_best_share,
        100.0 * figures.critical_share, 100.0 * figures.least_critical_share);
}

void print(const char* of, const StepScoreFigures& figures) {
    if (figures.scenes == 0) return;
    fmt::print(
        "{:<9} {:>6} scenes  right start {:.1f} %, right lane kept for 20 m {:.1f} %, whole {:.1f} %\n", of,
        figures.scenes, 100.0 * figures.start_share, 100.0 * figures.near_kept_share,
        100.0 * figures.kept_share);
}

/// Passes the file's text to `use`; an InvalidInput of it becomes an error in that file.
template <typename Use>
void read_file(const std::string& path, const char* option, const Use& use) {
    std::ifstream stream(path, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    if (!stream) throw InputError(path, 0, option, "cannot be read");
    try {
        use(text.str());
    } catch (const InvalidInput& error) {
        throw InputError(path, 0, "", error.what());
    }
}

void train_steps(Options& options) {
    StepTrainingRunOptions run;
    run.tracks = options.run.tracks;
    run.hold_out = options.run.hold_out;
    run.scenes = options.run.scenes;
    run.scenes.threads = options.threads;
    run.hold_out_every_m = options.run.hold_out_every_m;
    run.training = options.step_training;
    run.training.search = extended_search_options();
    run.training.seed = run.scenes.seed;
    AtomicFile output(options.out);
    const StepTrainingRun result = run_step_training(run);
    output.stream() << step_scores_json(result.scores, result.record);
    output.commit();
    print("training", result.trained);
    print("hold-out", result.held_out);
}

void train(Options& options) {
    if (options.steps) {
        train_steps(options);
        return;
    }
    TrainingRunOptions& run = options.run;
    run.training.inputs = options.extended ? kLaneFeatureCount : kPaperFeatureCount;
    if (options.extended) {
        run.candidates.search = extended_search_options();
        run.steps_record = step_scores_training(shipped_step_score_file());
        run.training.loss = RankLoss::choice;
    }
    if (!options.step_scores.empty()) {
        read_file(options.step_scores, "--step-scores", [&](const std::string& text) {
            run.candidates.search.step_scores = std::make_shared<StepScores>(parse_step_scores(text));
            run.steps_record = step_scores_training(text);
        });
    }
    run.candidates.search.iteration_limit = options.iterations;
    run.training.seed = run.scenes.seed;
    run.candidates.seed = run.scenes.seed;
    run.scenes.threads = options.threads;
    run.candidates.threads = options.threads;
    AtomicFile output(options.out);
    const TrainingRun result = run_training(run);
    output.stream() << rank_net_json(result.weights, result.record);
    output.commit();
    print("training", result.trained);
    print("hold-out", result.held_out);
}

constexpr int kMax = 1'000'000;

CLI::Option& add_count_option(CLI::App& command, const std::string& name, std::size_t& count,
                              const std::string& description, int least = 1) {
    return *command.add_option(name, count, description)
                ->check(whole_number(static_cast<std::size_t>(least), kMax))
                ->capture_default_str();
}

void add_number_option(CLI::App& command, const std::string& name, double& number,
                       const std::string& description) {
    command.add_option(name, number, description)->capture_default_str();
}

/// The tracks to train on, and those only to measure on.
CLI::Option& add_track_options(CLI::App& command, TrainingRunOptions& run) {
    command.add_option("--tracks", run.tracks,
                       "generated:NAME[@SEED], fsd:DIR[:1,2], pacsim:FILE, eufs:FILE or ftlog:FILE");
    command.add_option("--hold-out", run.hold_out, "tracks to measure on only, not to learn from");
    CLI::Option& variants = add_count_option(
        command, "--variants", run.variants,
        "number of variants of each track to train on too: stretched, every second one reversed", 0);
    add_scene_options(command, run.scenes);
    add_number_option(command, "--hold-out-every", run.hold_out_every_m,
                      "travel between poses on the tracks held out [m]");
    return variants;
}

/// One of the two networks, or the step scores; `variants`: the option that step scores do not use.
void add_kind_options(CLI::App& command, Options& options, CLI::Option& variants) {
    CLI::Option& extended =
        *command.add_flag("--extended", options.extended,
                          "the network of clc, on its search, by all features and the quality of its "
                          "choice; without it that of clc-paper");
    CLI::Option& steps = *command
                              .add_flag("--steps", options.steps,
                                        "train the step scores of clc's beam search instead of a network")
                              ->excludes(&extended)
                              ->excludes(&variants);
    command
        .add_option("--step-scores", options.step_scores,
                    "step scores (JSON) of the beam search that finds candidates, with --extended; "
                    "without it those of clc")
        ->needs(&extended)
        ->excludes(&steps);
}

void add_step_options(CLI::App& command, StepScoreTrainingOptions& training) {
    add_count_option(command, "--step-epochs", training.epochs, "rounds over the scenes, with --steps");
    add_number_option(command, "--step-rate", training.learning_rate, "learning rate of Adam, with --steps");
    add_number_option(command, "--step-decay", training.weight_decay,
                      "decay of a score by each step, times the rate, with --steps");
}

void add_network_options(CLI::App& command, RankNetTrainingOptions& training) {
    add_count_option(command, "--units", training.units, "number of units of the hidden layer");
    add_count_option(command, "--epochs", training.epochs, "rounds over the candidates");
    add_count_option(command, "--scenes-a-step", training.scenes_a_step,
                     "scenes to a step of Adam, with --extended");
    add_number_option(command, "--rate", training.learning_rate, "learning rate of Adam");
    add_number_option(command, "--decay", training.weight_decay,
                      "decay of the network's weights by each step, times the rate");
    add_number_option(command, "--iou-factor", training.iou_factor, "lambda_iou of equation (14)");
    add_number_option(
        command, "--divergence-penalty", training.divergence_penalty,
        "subtracted from the IoU of a lane that leaves the true one within 20 m; 0 in the paper");
    add_number_option(command, "--late-divergence-penalty", training.late_divergence_penalty,
                      "subtracted for a lane that leaves it later");
    add_number_option(command, "--unusable-penalty", training.unusable_penalty,
                      "also subtracted if a lane is not usable: wrong or too short");
    add_number_option(command, "--leader-share", training.leader_share,
                      "share of the pairs that hold the candidate ranked first so far");
}

}  // namespace

void add_train_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand(
        "train",
        "trains the ranking network of clc, or the step scores of its beam search; "
        "`conelane train front` trains the networks of front, `conelane train rld` the "
        "costs of RLD");
    auto options = std::make_shared<Options>();
    TrainingRunOptions& run = options->run;
    CLI::Option& variants = add_track_options(command, run);
    add_count_option(command, "--candidates", run.candidates.max_per_scene,
                     "largest number of candidates of a scene, drawn at random; 0 for all", 0);
    command.add_option("--iterations", options->iterations, "limit of each scene's search for candidates")
        ->check(whole_number(1, kMax))
        ->capture_default_str();
    add_kind_options(command, *options, variants);
    add_step_options(command, options->step_training);
    add_network_options(command, run.training);
    add_threads_option(command, options->threads, "the weights are the same with any number");
    add_output_option(command, "--out", options->out, "weights (JSON)");
    add_train_front_command(command);
    add_train_rld_command(command);
    command.callback([options, &command] {
        if (!command.get_subcommands().empty()) return;
        // Checked here: CLI11 would require an option of this command also for its sub-commands.
        for (const char* name : {"--tracks", "--out"}) {
            if (command.count(name) == 0) throw CLI::RequiredError(name);
        }
        train(*options);
    });
}

}  // namespace conelane::experiments
