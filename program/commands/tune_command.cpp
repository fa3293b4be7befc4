#include "evaluation/progress/progress.hpp"
#include "learning/tuning/rld_tuning.hpp"
#include "program/commands/command_parts.hpp"

namespace conelane::program {
namespace {

using nlohmann::ordered_json;

struct TuneOptions {
    std::vector<std::string> tracks;
    SceneOptions scenes;
    EvaluationOptions evaluation;
    TunerOptions tuner;
    std::string start;
    bool shape = false;
    std::string out;
};

/// Where the parameters are from: program, machine, scenes and work.
ordered_json record_of(const TuneOptions& options) {
    ordered_json json{{"commit", provenance().commit},
                      {"compiler", provenance().compiler},
                      {"machine", provenance().machine},
                      {"tracks", options.tracks}};
    json.update(scene_options_json(options.scenes));
    json["evaluations"] = options.tuner.evaluations;
    return json;
}

std::filesystem::path record_path(std::filesystem::path parameters) {
    return parameters.replace_extension(".record.json");
}

void tune_rld(TuneOptions& options) {
    if (!std::isfinite(options.evaluation.time_limit_ms)) {
        throw InvalidInput("--time-limit", "a tuning records one, inf is none");
    }
    options.scenes.threads = options.evaluation.threads;
    options.tuner.seed = options.scenes.seed;
    RldParameters start = ParameterSource{options.start, {}}.load();
    if (start.learned_costs)
        throw InvalidInput("--start", "has learned costs, which `conelane train rld` learns");
    if (options.shape) start = with_shape_costs(start);
    const Evaluation evaluation(make_scene_set(options.tracks, options.scenes), options.evaluation);
    Tuned tuned;
    {
        Progress progress("tune", 1 + options.tuner.evaluations);
        const auto evaluate = [&](const RldParameters& parameters) {
            const double figure = evaluation(parameters);
            progress.advance();
            return figure;
        };
        tuned = tune(evaluate, start, options.tuner);
    }
    ordered_json record{{"objective", to_string(options.evaluation.objective)}};
    record.update(record_of(options));
    record.update(ordered_json{{"time_limit_ms", options.evaluation.time_limit_ms},
                               {"most_nodes", options.evaluation.max_nodes},
                               {"pairing", to_string(start.pairing)},
                               {"w_color", start.w_color},
                               {"shape", has_shape_costs(start)},
                               {"use_confidence", start.use_confidence},
                               {"forbid_crossing", start.forbid_crossing},
                               {"scenes", evaluation.scenes().size()},
                               {"figure_of_start", tuned.figure_of_start},
                               {"figure", tuned.figure}});
    if (options.evaluation.nearest) record["nearest"] = *options.evaluation.nearest;
    if (options.evaluation.context) record["context"] = *options.evaluation.context;
    AtomicFile file(record_path(options.out));
    file.stream() << record.dump(2) << '\n';
    file.finish();
    {
        // Both or neither: only the renaming of the record is left.
        const auto held = hold_interruption();
        write_rld_parameters(options.out, tuned.parameters);
        file.commit();
    }
    fmt::print("{} on {} scenes: {:.2f} % before, {:.2f} % after\n", to_string(options.evaluation.objective),
               evaluation.scenes().size(), 100.0 * tuned.figure_of_start, 100.0 * tuned.figure);
}

}  // namespace

void add_tune_command(CLI::App& program) {
    CLI::App& command =
        *program.add_subcommand("tune", "finds the parameters of RLD that answer best on given tracks");
    auto options = std::make_shared<TuneOptions>();
    options->scenes.false_positive_rates = {0.0, 0.1, 0.3, 0.5};
    options->scenes.ranges_m = {30.0};
    options->scenes.every_m = 6.6;
    add_tracks_option(command, options->tracks)->required();
    const auto objectives = objective_names();
    command
        .add_option_function<std::string>(
            "--objective",
            [options, objectives](const std::string& name) {
                options->evaluation.objective =
                    static_cast<TuningObjective>(std::ranges::find(objectives, name) - objectives.begin());
            },
            "what to maximise, as a mean over scenes [accuracy]")
        ->check(CLI::IsMember(std::vector<std::string>(objectives.begin(), objectives.end())));
    add_nearest_option(command, options->evaluation.nearest, "cone-set size; all cones without it");
    command
        .add_option_function<std::size_t>(
            "--context", [options](std::size_t count) { options->evaluation.context = count; },
            "find the lane among this many nearest cones, then cut it to --nearest")
        ->needs("--nearest")
        ->check(whole_number(1, 100'000));
    add_scene_options(command, options->scenes);
    add_time_limit_option(command, options->evaluation.time_limit_ms);
    add_field_options(
        command, {{"--most-nodes", "", &options->evaluation.max_nodes, OptionRange{1.0, 1e9},
                   "largest number of nodes of a scene's search; a search that takes more counts as wrong"},
                  {"--evaluations", "", &options->tuner.evaluations, OptionRange{0.0, 1e6},
                   "largest number of parameter sets that the search evaluates"}});
    command.add_option(
        "--start", options->start,
        "parameters to start from: a name or a file, as for --params elsewhere; without it the defaults");
    command.add_flag("--shape", options->shape, "start with the costs of a lane's shape and tune them too");
    add_threads_option(command, options->evaluation.threads, "scenes solved at a time");
    add_output_option(command, "--out", options->out, "P.json; its record goes to P.record.json")->required();
    command.callback([options] { tune_rld(*options); });
}

}  // namespace conelane::program
