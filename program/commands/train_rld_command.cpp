#include "evaluation/formats/parameter_file.hpp"
#include "experiments/options/shared_options.hpp"
#include "experiments/options/whole_number.hpp"
#include "experiments/training/rld_training_run.hpp"
#include "program/commands/commands.hpp"

#include <cstdio>
#include <memory>
#include <string>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

struct Options {
    RldTrainingRunOptions run;
    std::string parameters;
    std::string out;
};

void print(const RldProgress& progress) {
    fmt::print(
        "step {} of {}: loss {:.4f}; of {} scenes the true lane is allowed in {:.1f} %; of these {:.1f} % "
        "have "
        "no cheaper rival, {:.1f} % searched to the end\n",
        progress.step, progress.steps, progress.hinge, progress.scenes, 100.0 * progress.allowed,
        100.0 * progress.found, 100.0 * progress.proven);
    std::fflush(stdout);
}

void train(Options options) {
    if (!options.parameters.empty())
        options.run.training.parameters = ParameterSource{options.parameters, {}}.load();
    const RldTrainingRun result = run_rld_training(options.run, print);
    write_rld_parameters(options.out, result.parameters, result.record);
}

void add_count_option(CLI::App& command, const std::string& name, std::size_t& count,
                      const std::string& description, int least = 1) {
    constexpr int kMax = 10'000'000;
    command.add_option(name, count, description)
        ->check(whole_number(static_cast<std::size_t>(least), kMax))
        ->capture_default_str();
}

void add_number_option(CLI::App& command, const std::string& name, double& number,
                       const std::string& description) {
    command.add_option(name, number, description)->capture_default_str();
}

}  // namespace

void add_train_rld_command(CLI::App& train_command) {
    CLI::App& command = *train_command.add_subcommand(
        "rld", "learns costs of the RLD program with its exact search inside: edges, turns and ends");
    auto options = std::make_shared<Options>();
    RldTrainingOptions& training = options->run.training;
    command
        .add_option("--tracks", options->run.tracks,
                    "generated:NAME[@SEED], fsd:DIR[:1,2], pacsim:FILE or eufs:FILE")
        ->required();
    command.add_option(
        "--params", options->parameters,
        "parameters that the costs are added to, a set or a file (JSON), whose learned costs the training "
        "begins with; without it limits that allow most true lanes, and no other cost");
    add_count_option(command, "--units", training.units,
                     "hidden units of each network; 0 for linear costs, a readable weight a feature", 0);
    add_count_option(command, "--steps", training.steps, "steps of Adam", 0);
    add_number_option(command, "--rate", training.learning_rate, "learning rate, which falls to 0");
    add_count_option(command, "--draws", training.draws_per_step, "changed courses in each step");
    add_count_option(command, "--scenes-a-draw", training.scenes.scenes_per_draw,
                     "scenes of each changed course");
    add_number_option(
        command, "--margin", training.margin.near,
        "cost by which the true lane has to beat another one, for each edge within 20 m that differs");
    add_number_option(command, "--far-margin", training.margin.far, "the same beyond 20 m");
    add_number_option(command, "--highest-rate", training.scenes.highest_rate,
                      "share of false positives is drawn up to this");
    command
        .add_option("--max-work", training.max_work,
                    "limit of each exact search, in steps of about a nanosecond; then its best lane counts")
        ->capture_default_str();
    add_count_option(command, "--report-every", training.report_every, "steps between two lines of output");
    command.add_option("--checkpoint", training.checkpoint,
                       "file of the training's state, from which a stopped training resumes");
    command.add_option("--seed", training.seed, "seed of all random draws")->capture_default_str();
    add_threads_option(command, training.threads, "the costs are the same with any number");
    add_output_option(command, "--out", options->out,
                      "parameters (JSON); the costs get a file beside it, FILE.weights.json for FILE.json")
        ->required();
    command.callback([options] { train(*options); });
}

}  // namespace conelane::experiments
