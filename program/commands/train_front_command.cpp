#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/file_hash.hpp"
#include "evaluation/formats/front_weights_file.hpp"
#include "evaluation/input_error.hpp"
#include "experiments/options/shared_options.hpp"
#include "experiments/options/whole_number.hpp"
#include "experiments/training/front_training_run.hpp"
#include "graph_search/front/front_weights_reader.hpp"
#include "program/commands/commands.hpp"

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

struct Options {
    FrontTrainingRunOptions run;
    std::string from;
    std::string out;
};

void print(const std::string& of, const FrontFigures& figures) {
    const auto percent = [](std::optional<double> share) { return 100.0 * share.value_or(0.0); };
    const Calibration& said = figures.calibration;
    fmt::print(
        "  {:<6} {:>6} scenes  usable {:.2f} %, IoU {:.2f} %, exact {:.1f} %; confidence off by {:.2f} %, "
        "{:.1f} % sure, of these usable {:.2f} %; trusted {:.1f} %, right there {:.2f} %\n",
        of, figures.scenes, 100.0 * figures.usable, 100.0 * figures.iou, 100.0 * figures.exact,
        percent(said.error()), percent(said.sure()), percent(said.usable_where_sure()),
        percent(said.trusted_share()), percent(said.right_where_trusted()));
}

void print(const FrontProgress& progress, const FrontTrainingRunOptions& run) {
    using Stage = FrontProgress::Stage;
    fmt::print("step {} of {}, {}: loss {:.4f}", progress.step, progress.steps,
               progress.stage == Stage::move_by_move     ? "move by move"
               : progress.stage == Stage::through_search ? "through the search"
                                                         : "judging",
               progress.loss);
    if (progress.stage != Stage::judging)
        fmt::print(", true lane allowed {:.1f} %", 100.0 * progress.reached);
    if (progress.stage == Stage::through_search)
        fmt::print(", kept {:.1f} %, answered {:.1f} %", 100.0 * progress.kept, 100.0 * progress.found);
    if (progress.stage == Stage::judging) fmt::print(", usable {:.1f} %", 100.0 * progress.found);
    if (progress.stage != Stage::move_by_move) fmt::print(", risk {:.4f}", progress.risk);
    fmt::print("\n");
    for (std::size_t i = 0; i < progress.held_out.size(); ++i) print(run.conditions[i], progress.held_out[i]);
    std::fflush(stdout);
}

void train(Options options) {
    if (!options.from.empty()) {
        options.run.training.initial = read_front_weights(options.from);
        options.run.training.initial_name = file_hash(options.from);
    }
    AtomicFile output(options.out);
    const FrontTrainingRun result =
        run_front_training(options.run, [&](const FrontProgress& progress) { print(progress, options.run); });
    output.stream() << front_weights_json(result.weights, result.record);
    output.commit();
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

void add_train_front_command(CLI::App& train_command) {
    CLI::App& command = *train_command.add_subcommand(
        "front", "trains the weights of front: move by move along true lanes, then through its search");
    auto options = std::make_shared<Options>();
    FrontTrainingRunOptions& run = options->run;
    FrontTrainingOptions& training = run.training;
    command
        .add_option("--tracks", run.tracks, "generated:NAME[@SEED], fsd:DIR[:1,2], pacsim:FILE or eufs:FILE")
        ->required();
    command.add_option("--hold-out", run.hold_out, "tracks to measure on only, not to learn from");
    command.add_option("--trust-tracks", run.trust_tracks,
                       "tracks to choose the threshold of trust on, not to learn from; without them it is "
                       "chosen on new draws of --tracks");
    add_number_option(command, "--hold-out-every", run.hold_out_every_m,
                      "travel between poses on the tracks held out [m]");
    command.add_option("--condition", run.conditions, "conditions of the held-out scenes: paper, car, harsh")
        ->delimiter(',')
        ->capture_default_str();
    command.add_option("--fp", run.rates, "share of false positives among all points of the scenes held out")
        ->delimiter(',')
        ->capture_default_str();
    add_count_option(command, "--imitation-steps", training.imitation_steps, "steps of Adam move by move", 0);
    add_count_option(command, "--search-steps", training.search_steps, "steps of Adam through the search", 0);
    add_count_option(command, "--judge-steps", training.judge_steps,
                     "steps of Adam of the judge of whole lanes", 0);
    command
        .add_option(
            "--judge-parts", training.judge_parts,
            "networks of the judge that are learned: rank, usable (its confidence), right; the others "
            "stay as they are. With usable alone the order of the lanes does not change")
        ->delimiter(',')
        ->capture_default_str();
    add_number_option(command, "--imitation-rate", training.imitation_rate, "learning rate move by move");
    add_number_option(command, "--search-rate", training.search_rate, "learning rate through the search");
    add_number_option(command, "--judge-rate", training.judge_rate, "learning rate of the judge");
    add_number_option(command, "--trusted", training.trusted,
                      "target share of lanes that are right as far as they are trusted");
    add_count_option(command, "--trust-draws", training.trust_draws,
                     "changed courses on which the threshold for it is set, after the training");
    add_count_option(command, "--draws", training.draws_per_step, "changed courses in each step");
    add_count_option(command, "--scenes-a-draw", training.scenes.scenes_per_draw,
                     "scenes of each changed course");
    add_count_option(command, "--beam", training.loss.search.beam_width, "width of the beam in training");
    add_number_option(command, "--fall-out", training.loss.fall_out,
                      "weight of the loss where the true lane leaves the beam");
    add_number_option(command, "--minimum-risk", training.loss.minimum_risk, "weight of the expected risk");
    add_number_option(command, "--listwise", training.loss.listwise,
                      "weight of the loss over the best lanes");
    add_count_option(command, "--figures-every", training.figures_every,
                     "steps between two measurements on the tracks held out");
    command.add_option(
        "--from", options->from,
        "weights to begin with, such as those of an earlier version; drawn weights without it. "
        "The record has the hash of the file");
    command.add_option("--checkpoint", training.checkpoint,
                       "file of the training's state, from which a stopped training resumes");
    command.add_option("--seed", training.seed, "seed of all random draws")->capture_default_str();
    command.add_flag("!--no-warp", training.scenes.warp, "courses keep their shape");
    command.add_flag("!--no-respacing", training.scenes.respace,
                     "cones stay where they are on their boundary");
    command.add_flag("!--no-disturbance", training.scenes.disturb, "no noise, missed cones and pose error");
    command.add_flag("--other-course", training.scenes.other_course,
                     "a second course lies beside the first in a third of the draws");
    add_number_option(command, "--colored-share", training.scenes.colored_share,
                      "share of the draws whose cones have colours");
    command.add_flag(
        "--only-colors", training.only_colors,
        "with --from: only the set of weights for scenes with colours is learned, so that without colours "
        "nothing changes");
    add_number_option(command, "--noise-share", training.scenes.noise_share,
                      "share of the draws that have a scene of false cones alone, for the judge");
    command.add_option("--noise-cones", training.scenes.noise_cones, "fewest and most cones of such a scene")
        ->capture_default_str();
    command
        .add_option("--noise-ranges", training.scenes.noise_ranges_m,
                    "smallest and largest radius of the half disc that holds them [m]")
        ->capture_default_str();
    command
        .add_flag_callback(
            "--no-noise-scenes", [&training] { training.scenes.noise_share = 0.0; },
            "the judge sees no scenes of false cones alone")
        ->excludes("--noise-share");
    command.add_flag("!--no-short-sight", training.scenes.short_sight,
                     "true cones are seen as far as false ones");
    command
        .add_option("--without", training.without,
                    "inputs of the cost to leave out, by their names in front_features.cpp")
        ->delimiter(',');
    add_threads_option(command, training.threads, "the weights are the same with any number");
    add_output_option(command, "--out", options->out, "weights (JSON)")->required();
    command.callback([options] { train(*options); });
}

}  // namespace conelane::experiments
