#include "conelane/invalid_input.hpp"
#include "conelane/rld_parameters.hpp"
#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/parameter_file.hpp"
#include "evaluation/formats/provenance.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "evaluation/formats/track_spec.hpp"
#include "experiments/methods/method.hpp"
#include "experiments/options/shared_options.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/tuning/detector_tuning.hpp"
#include "experiments/tuning/evaluation.hpp"
#include "experiments/tuning/evaluation_log.hpp"
#include "experiments/tuning/failure_causes.hpp"
#include "experiments/tuning/tuner.hpp"
#include "experiments/tuning/weight_fit.hpp"
#include "program/commands/commands.hpp"
#include "program/commands/field_options.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane::experiments {
namespace {

using nlohmann::ordered_json;

struct TuneOptions {
    std::string detector;  ///< empty: RLD
    std::vector<std::string> tracks;
    SceneOptions scenes;
    EvaluationOptions evaluation;
    TunerOptions tuner;
    std::size_t rounds = 0;
    std::string start;
    bool shape = false;
    std::string out;
    std::filesystem::path log;
};

/// Everything that the figures of parameters depend on; `start` for what tuning does not change.
ordered_json conditions(const TuneOptions& options, const RldParameters& start) {
    ordered_json json{{"commit", provenance().commit},
                      {"tracks", options.tracks},
                      {"objective", to_string(options.evaluation.objective)}};
    json.update(scene_options_json(options.scenes));
    json.update(ordered_json{{"time_limit_ms", options.evaluation.time_limit_ms},
                             {"most_nodes", options.evaluation.max_nodes},
                             {"pairing", to_string(start.pairing)},
                             {"w_color", start.w_color},
                             {"shape", has_shape_costs(start)},
                             {"use_confidence", start.use_confidence},
                             {"forbid_crossing", start.forbid_crossing}});
    if (options.evaluation.nearest) json["nearest"] = *options.evaluation.nearest;
    if (options.evaluation.context) json["context"] = *options.evaluation.context;
    return json;
}

ordered_json to_json(const RldParameters& parameters) {
    ordered_json json = ordered_json::object();
    for (const auto& fields : {rld_parameter_fields(), rld_extra_fields()}) {
        for (const RldParameterField& field : fields) json[std::string(field.key)] = parameters.*field.value;
        if (!has_shape_costs(parameters)) break;
    }
    return json;
}

/// The mean over all scenes, and by rate and by track.
ordered_json to_json(const std::vector<LapFigure>& laps) {
    ordered_json json{{"mean", mean_over_scenes(laps)}};
    const auto add_means = [&](const char* key, const auto& key_of) {
        ordered_json means = ordered_json::object();
        for (const LapFigure& lap : laps) {
            if (means.contains(key_of(lap))) continue;
            std::vector<LapFigure> same;
            for (const LapFigure& other : laps) {
                if (key_of(other) == key_of(lap)) same.push_back(other);
            }
            means[key_of(lap)] = mean_over_scenes(same);
        }
        json[key] = means;
    };
    add_means("by_rate", [](const LapFigure& lap) { return fmt::format("{}", lap.rate); });
    add_means("by_track", [](const LapFigure& lap) { return lap.track; });
    return json;
}

/// For each rate: number of scenes by cause of inaccuracy, and where inaccurate scenes have wrong cones.
struct FailureCounts {
    ordered_json causes = ordered_json::object();
    ordered_json places = ordered_json::object();
};

void count_one(ordered_json& counts, std::string_view name) {
    ordered_json& count = counts[std::string(name)];
    count = count.is_null() ? 1 : count.get<std::size_t>() + 1;
}

FailureCounts count_failures(const std::vector<AnnotatedScene>& scenes, const RldParameters& parameters,
                             const EvaluationOptions& options) {
    FailureCounts counts;
    for (const AnnotatedScene& scene : scenes) {
        const std::string rate = fmt::format("{}", scene.false_positive_rate.value_or(0.0));
        const Diagnosis found = diagnose(scene, parameters, options);
        count_one(counts.causes[rate], to_string(found.cause));
        if (!found.wrong) continue;
        ordered_json& places = counts.places[rate];
        for (const auto& [name, cones] :
             {std::pair("near_end", found.wrong->near_end), std::pair("inside", found.wrong->inside),
              std::pair("far_end", found.wrong->far_end),
              std::pair("lost_boundary", found.wrong->on_lost_boundary)}) {
            if (cones > 0) count_one(places, name);
        }
        if (*found.wrong == WrongCones{}) count_one(places, "none");
    }
    return counts;
}

/// Two lines for each rate: shares of the scenes that count.
void print_failures(const FailureCounts& failures) {
    const std::string not_counted(to_string(FailureCause::no_ground_truth));
    for (const auto& [rate, causes] : failures.causes.items()) {
        double scenes = 0.0;
        for (const auto& [cause, count] : causes.items()) {
            if (cause != not_counted) scenes += count.get<double>();
        }
        const auto shares = [&](const ordered_json& counts) {
            std::vector<std::string> parts;
            for (const auto& [name, count] : counts.items()) {
                if (name != not_counted)
                    parts.push_back(fmt::format("{} {:.1f} %", name, 100.0 * count.get<double>() / scenes));
            }
            return fmt::format("{}", fmt::join(parts, ", "));
        };
        fmt::print("false positives {}: {}\n", rate, shares(causes));
        if (failures.places.contains(rate))
            fmt::print("    wrong cones at: {}\n", shares(failures.places[rate]));
    }
}

ordered_json record_of(const TuneOptions& options, const RldParameters& start, const Tuned& tuned) {
    ordered_json record = conditions(options, start);
    record["folds"] = options.tuner.folds;
    record["rounds"] = options.rounds;
    record["evaluations"] = options.tuner.evaluations;
    record["compiler"] = provenance().compiler;
    record["machine"] = provenance().machine;
    ordered_json folds = ordered_json::array();
    std::vector<LapFigure> held_out;
    for (const Fold& fold : tuned.folds) {
        held_out.insert(held_out.end(), fold.held_out_laps.begin(), fold.held_out_laps.end());
        folds.push_back({{"held_out", fold.held_out},
                         {"training", fold.training},
                         {"held_out_figures", to_json(fold.held_out_laps)},
                         {"held_out_figures_of_start", to_json(fold.held_out_laps_of_start)},
                         {"parameters", to_json(fold.parameters)}});
    }
    if (!tuned.folds.empty()) record["held_out_figures"] = to_json(held_out);
    record["figures_of_start"] = to_json(tuned.laps_of_start);
    record["figures"] = to_json(tuned.laps);
    record["fold_results"] = folds;
    return record;
}

std::filesystem::path record_path(std::filesystem::path parameters) {
    return parameters.replace_extension(".record.json");
}

ordered_json describe(const DetectorFigure& figure) {
    return {{"scenes", figure.scenes}, {"usable", figure.usable}, {"iou", figure.iou}};
}

/// Tunes a detector with parameters of its own, for usable lanes.
void tune_method(TuneOptions& options) {
    const DetectorRecipe& recipe = find_tunable(options.detector);
    options.scenes.threads = options.evaluation.threads;
    const DetectorTuningOptions tuning{.evaluations = options.tuner.evaluations,
                                       .seed = options.scenes.seed,
                                       .threads = options.evaluation.threads};
    const SceneSet set = make_scene_set(options.tracks, options.scenes);
    TuningResult tuned;
    {
        Progress progress("tune " + options.detector, tuning.evaluations);
        tuned = tune_detector(recipe, set, tuning, [&] { progress.advance(); });
    }
    ordered_json record{{"method", options.detector},
                        {"commit", provenance().commit},
                        {"compiler", provenance().compiler},
                        {"machine", provenance().machine},
                        {"tracks", options.tracks}};
    record.update(scene_options_json(options.scenes));
    record["evaluations"] = tuning.evaluations;
    record["figure_of_start"] = describe(tuned.figure_of_start);
    record["figure"] = describe(tuned.figure);
    AtomicFile record_file(record_path(options.out));
    record_file.stream() << record.dump(2) << '\n';
    AtomicFile parameters(options.out);
    parameters.stream() << to_json_text(recipe, tuned.values);
    commit_together(std::array{&record_file, &parameters});
    const auto text = [](const DetectorFigure& figure) {
        return fmt::format("{:.1f} % usable, IoU {:.1f} %", 100.0 * figure.usable, 100.0 * figure.iou);
    };
    fmt::print("{} on {} scenes: {} before, {} after\n", options.detector, tuned.figure.scenes,
               text(tuned.figure_of_start), text(tuned.figure));
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
    EvaluationLog log(options.log, to_line(conditions(options, start)),
                      [&](const RldParameters& parameters) { return evaluation(parameters); });
    const std::size_t fits = options.tuner.folds > 1 ? options.tuner.folds + 1 : 1;
    Tuned tuned;
    {
        // The figures of the start, and for each fit those of start and winner on the held-out tracks.
        Progress progress(
            "tune", 1 + fits * (solves_in(options.rounds) + options.rounds + options.tuner.evaluations + 2));
        const auto evaluate = [&](const RldParameters& parameters) {
            std::vector<LapFigure> laps = log(parameters);
            progress.advance();
            return laps;
        };
        const WeightRoundsOptions rounds{options.rounds, options.scenes.seed, [&] { progress.advance(); }};
        const auto propose = [&](const RldParameters& from, const std::set<std::string>& tracks) {
            return fit_weights_in_rounds(evaluation, from, tracks, rounds);
        };
        tuned = tune(evaluate, start, options.tuner, propose);
    }
    ordered_json record = record_of(options, start, tuned);
    const FailureCounts failures = count_failures(evaluation.scenes(), tuned.parameters, options.evaluation);
    record["losses"] = failures.causes;  // the key in all records so far
    record["wrong_cones"] = failures.places;
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
               evaluation.scenes().size(), 100.0 * mean_over_scenes(tuned.laps_of_start),
               100.0 * mean_over_scenes(tuned.laps));
    for (const Fold& fold : tuned.folds) {
        fmt::print("held out {}: {:.2f} % before, {:.2f} % after\n", fmt::join(fold.held_out, " "),
                   100.0 * mean_over_scenes(fold.held_out_laps_of_start),
                   100.0 * mean_over_scenes(fold.held_out_laps));
    }
    print_failures(failures);
}

}  // namespace

void add_tune_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand(
        "tune", "finds the parameters of RLD, or of another method, that answer best on given tracks");
    auto options = std::make_shared<TuneOptions>();
    options->scenes.false_positive_rates = {0.0, 0.1, 0.3, 0.5};
    options->scenes.ranges_m = {30.0};
    options->scenes.every_m = 6.6;
    command.add_option("--method", options->detector,
                       fmt::format("{}, tuned for usable lanes; RLD without it, to which the options "
                                   "from --objective to --most-nodes and from --folds to --log belong",
                                   fmt::join(tunable_names(), " or ")));
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
        command, {{"--most-nodes",
                   "",
                   &options->evaluation.max_nodes,
                   {1.0, 1e9},
                   "largest number of nodes of a scene's search; a search that takes more counts as wrong"},
                  {"--folds",
                   "",
                   &options->tuner.folds,
                   {1.0, 1000.0},
                   "number of groups of tracks; each group is held out once; 1 holds none out"},
                  {"--rounds",
                   "",
                   &options->rounds,
                   {0.0, 1000.0},
                   "rounds that fit the weights to the lane graphs found so far, before the search of each "
                   "fit; not in "
                   "the log"},
                  {"--evaluations",
                   "",
                   &options->tuner.evaluations,
                   {0.0, 1e6},
                   "largest number of parameter sets that the search evaluates in each fit"}});
    command.add_option(
        "--start", options->start,
        "parameters to start from: a name or a file, as for --params elsewhere; without it the defaults");
    command.add_flag("--shape", options->shape, "start with the costs of a lane's shape and tune them too");
    add_threads_option(command, options->evaluation.threads, "scenes solved at a time");
    add_output_option(command, "--out", options->out, "P.json; its record goes to P.record.json")->required();
    command.add_option(
        "--log", options->log,
        "*.jsonl, a line for each evaluation; with the same log, a tuning that was stopped resumes");
    for (const char* const of_rld : {"--objective", "--nearest", "--context", "--time-limit", "--most-nodes",
                                     "--folds", "--rounds", "--start", "--shape", "--log"})
        command.get_option(of_rld)->excludes("--method");
    command.callback([options, &command] {
        if (options->detector.empty()) return tune_rld(*options);
        if (command.count("--every") == 0) options->scenes.every_m = 8.8;
        if (command.count("--evaluations") == 0)
            options->tuner.evaluations = DetectorTuningOptions{}.evaluations;
        tune_method(*options);
    });
}

}  // namespace conelane::experiments
