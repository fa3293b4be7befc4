#include "experiments/studies/confidence_and_colour.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/parameter_file.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "experiments/options/shared_options.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/studies/study.hpp"
#include "experiments/tuning/tuner.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane::experiments {
namespace {

std::vector<double> numbers_of(const JsonNode& array) {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < array.array_size(); ++i) numbers.push_back(array.element(i).number());
    return numbers;
}

std::vector<std::string> strings_of(const JsonNode& array) {
    std::vector<std::string> strings;
    for (std::size_t i = 0; i < array.array_size(); ++i) strings.push_back(array.element(i).string());
    return strings;
}

bool holds_out(const HeldOut& fold, const std::string& track) {
    return std::ranges::find(fold.tracks, track) != fold.tracks.end();
}

/// Sums of values over scenes, by rate.
using ByRate = std::map<double, LapFigure>;

void add_held_out(ByRate& sums, const HeldOut& fold, const std::vector<std::string>& only,
                  std::span<const LapFigure> laps) {
    for (const LapFigure& lap : laps) {
        if (!holds_out(fold, lap.track)) continue;
        if (!only.empty() && std::ranges::find(only, lap.track) == only.end()) continue;
        sums[lap.rate].scenes += lap.scenes;
        sums[lap.rate].sum += lap.sum;
    }
}

double mean_of(const LapFigure& sums) {
    return sums.scenes == 0 ? 0.0 : sums.sum / static_cast<double>(sums.scenes);
}

double mean_of_others(const HeldOut& fold, std::vector<LapFigure> laps) {
    std::erase_if(laps, [&](const LapFigure& lap) { return holds_out(fold, lap.track); });
    return mean_over_scenes(laps);
}

SceneSet scenes_with(const SimulatedKnowledge& knowledge, const ConfidenceColorOptions& options) {
    SceneOptions scenes = options.scenes;
    scenes.with_confidence = knowledge.confidence;
    scenes.with_color = knowledge.color_error.has_value();
    scenes.color_error_rate = knowledge.color_error.value_or(0.0);
    return make_scene_set(options.tracks, scenes);
}

Evaluation evaluation_of(const SceneSet& set, TuningObjective objective,
                         const ConfidenceColorOptions& options) {
    EvaluationOptions evaluation = options.evaluation;
    evaluation.objective = objective;
    return {set, evaluation};
}

void require_held_out_tracks(const SceneSet& set, const ConfidenceColorOptions& options) {
    for (const std::string& track : options.only) {
        if (std::ranges::none_of(options.folds, [&](const HeldOut& fold) { return holds_out(fold, track); }))
            throw InvalidInput("--only", "no fold holds out '" + track + "'");
    }
    for (const HeldOut& fold : options.folds) {
        for (const std::string& track : fold.tracks) {
            if (!set.tracks.contains(track))
                throw InvalidInput("--tracks", "there is no track '" + track + "', which a fold holds out");
        }
    }
}

/// The fold's parameters with each value of the weight.
std::vector<RldParameters> choices(const SimulatedKnowledge& knowledge, const HeldOut& fold,
                                   const ConfidenceColorOptions& options) {
    std::vector<RldParameters> choices;
    const auto add = [&](const std::vector<double>& weights, double RldParameters::*weight) {
        for (const double value : weights) {
            choices.push_back(fold.parameters);
            choices.back().use_confidence = knowledge.confidence;
            choices.back().*weight = value;
        }
    };
    if (knowledge.confidence) add(options.benefits, &RldParameters::w_b);
    if (knowledge.color_error) add(options.color_weights, &RldParameters::w_color);
    if (choices.empty()) choices.push_back(fold.parameters);
    return choices;
}

std::vector<ConfidenceColorRow> rows_with(const SimulatedKnowledge& knowledge,
                                          const ConfidenceColorOptions& options, Progress& progress) {
    const SceneSet set = scenes_with(knowledge, options);
    require_held_out_tracks(set, options);
    const Evaluation accuracy = evaluation_of(set, TuningObjective::accuracy, options);
    const Evaluation success = evaluation_of(set, TuningObjective::success, options);
    ByRate accurate;
    ByRate successful;
    std::vector<double> chosen;
    for (const HeldOut& fold : options.folds) {
        RldParameters best;
        std::vector<LapFigure> laps_of_best;
        for (const RldParameters& parameters : choices(knowledge, fold, options)) {
            std::vector<LapFigure> laps = accuracy(parameters);
            progress.advance();
            if (!laps_of_best.empty() && mean_of_others(fold, laps) <= mean_of_others(fold, laps_of_best)) {
                continue;
            }
            best = parameters;
            laps_of_best = std::move(laps);
        }
        add_held_out(accurate, fold, options.only, laps_of_best);
        add_held_out(successful, fold, options.only, success(best));
        if (knowledge.confidence) chosen.push_back(best.w_b);
        if (knowledge.color_error) chosen.push_back(best.w_color);
    }
    std::vector<ConfidenceColorRow> rows;
    for (const auto& [rate, sums] : accurate) {
        rows.push_back({knowledge, rate, sums.scenes, mean_of(sums), mean_of(successful[rate]), chosen});
    }
    return rows;
}

RowFields<ConfidenceColorRow> color_fields(const EvaluationOptions& evaluation) {
    using Row = ConfidenceColorRow;
    const auto weights = [](const Row& row) { return fmt::format("{}", fmt::join(row.weights, " ")); };
    return {{"known", [](const Row& row) { return to_string(row.knowledge); }, Shown::text("known")},
            {"confidence", [](const Row& row) { return row.knowledge.confidence; }},
            {"color_error", [](const Row& row) { return row.knowledge.color_error; }},
            {"false_positive_rate", &Row::false_positive_rate, Shown::percent("fp %", 1)},
            {"scenes", &Row::scenes, Shown::number("scenes")},
            {"accurate", &Row::accurate, Shown::percent("accurate %", 1)},
            {"success", &Row::success, Shown::percent("success %", 1)},
            {"weights", [](const Row& row) { return row.weights.empty() ? FieldValue() : row.weights; }},
            {"", [weights](const Row& row) { return row.weights.empty() ? "-" : weights(row); },
             Shown::text("w_b or w_color by fold")},
            {"nearest", [nearest = evaluation.nearest](const Row&) { return nearest; }},
            {"context", [context = evaluation.context](const Row&) { return context; }}};
}

class ConfidenceAndColorStudy : public Study {
  public:
    ConfidenceAndColorStudy()
        : Study({"confidence-and-colour",
                 "how much more accurate is RLD with detection confidences, or with cone colours of which "
                 "some are wrong?",
                 "Confidences and colours are simulated on the scenes of a tuning whose parameters were "
                 "fitted to geometry alone. Each fold answers for the tracks that it held out; the weight of "
                 "what is simulated (w_b with confidences, w_color with colours) is chosen on the others."}) {
    }

    void add_options(CLI::App& command) override {
        command.add_option("--record", record_, "P.record.json of `conelane tune`, with folds")->required();
        command.add_option("--tracks", tracks_,
                           "the record's tracks where they lie elsewhere; without it as in the record");
        command.add_option("--only", only_, "names of the tracks that count; all without it");
        command.add_option("--every", every_m_, "travel between poses instead of the record's [m]");
        add_seed_option(command, seed_, "base seed instead of the record's");
        add_threads_option(command, threads_, "number of threads; nothing is timed");
    }

    StudyResult run() override {
        ConfidenceColorOptions options = read_tuning_record(record_);
        if (!tracks_.empty()) options.tracks = tracks_;
        options.only = only_;
        options.scenes.every_m = every_m_.value_or(options.scenes.every_m);
        options.scenes.seed = seed_.value_or(options.scenes.seed);
        options.scenes.threads = threads_;
        options.evaluation.threads = threads_;
        return study_result(confidence_color_rows(options), color_fields(options.evaluation));
    }

  private:
    std::string record_;
    std::vector<std::string> tracks_;
    std::vector<std::string> only_;
    std::optional<double> every_m_;
    std::optional<std::uint64_t> seed_;
    unsigned threads_ = 1;
};

}  // namespace

ConfidenceColorOptions read_tuning_record(const std::filesystem::path& file) {
    ConfidenceColorOptions options;
    with_json_file(file, [&](const JsonNode& json) {
        options.tracks = strings_of(json.member("tracks"));
        SceneOptions& scenes = options.scenes;
        scenes.false_positive_rates = numbers_of(json.member("fp"));
        scenes.ranges_m = numbers_of(json.member("range"));
        scenes.every_m = json.member("every").number();
        if (const auto names = json.find("condition")) {
            scenes.conditions = strings_of(*names);  // they include all disturbances
        } else {
            scenes.noise_sigma_m = json.member("noise").number();
            const JsonNode pose_noise = json.member("pose_noise");
            if (pose_noise.array_size() != 2) pose_noise.fail("must be two numbers");
            scenes.pose_noise_lateral_m = pose_noise.element(0).number();
            scenes.pose_noise_yaw_rad = pose_noise.element(1).number();
            scenes.miss_rate = json.member("miss").number();
            if (const auto persistent = json.find("persist")) scenes.persistent = persistent->boolean();
        }
        scenes.seed = json.member("seed").unsigned_integer();
        options.evaluation.time_limit_ms = json.member("time_limit_ms").non_negative_number();
        options.evaluation.max_nodes = json.member("most_nodes").non_negative_integer();
        if (const auto nearest = json.find("nearest"))
            options.evaluation.nearest = nearest->unsigned_integer();
        if (const auto context = json.find("context"))
            options.evaluation.context = context->unsigned_integer();
        const JsonNode folds = json.member("fold_results");
        constexpr std::array kPairings{Pairing::near_far, Pairing::paper};
        const Pairing pairing = json.member("pairing").one_of(kPairings);
        const bool forbid_crossing = json.member("forbid_crossing").boolean();
        for (std::size_t i = 0; i < folds.array_size(); ++i) {
            const JsonNode fold = folds.element(i);
            RldParameters parameters = rld_parameters_of(fold.member("parameters"));
            parameters.pairing = pairing;
            parameters.forbid_crossing = forbid_crossing;
            options.folds.push_back({strings_of(fold.member("held_out")), parameters});
        }
        if (options.folds.empty()) folds.fail("no track was held out");
        json.require_valid([&] { validate(scenes); });
    });
    return options;
}

std::string to_string(const SimulatedKnowledge& knowledge) {
    std::vector<std::string> parts;
    if (knowledge.confidence) parts.emplace_back("confidences");
    if (knowledge.color_error) {
        parts.push_back(*knowledge.color_error == 0.0
                            ? "right colours"
                            : fmt::format("colours, {:g} % wrong", 100.0 * *knowledge.color_error));
    }
    return parts.empty() ? "geometry alone" : fmt::format("{}", fmt::join(parts, ", "));
}

std::vector<ConfidenceColorRow> confidence_color_rows(const ConfidenceColorOptions& options) {
    std::vector<SimulatedKnowledge> all{{}, {.confidence = true, .color_error = {}}};
    for (const double error : options.color_errors)
        all.push_back({.confidence = false, .color_error = error});
    const std::size_t evaluations =
        1 + options.benefits.size() + options.color_errors.size() * options.color_weights.size();
    Progress progress("confidence and colour", options.folds.size() * evaluations);
    std::vector<ConfidenceColorRow> rows;
    for (const SimulatedKnowledge& knowledge : all) {
        std::ranges::move(rows_with(knowledge, options, progress), std::back_inserter(rows));
    }
    return rows;
}

std::unique_ptr<Study> make_confidence_and_color_study() {
    return std::make_unique<ConfidenceAndColorStudy>();
}

}  // namespace conelane::experiments
