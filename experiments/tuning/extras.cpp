#include "experiments/tuning/extras.hpp"

#include "experiments/files/figure_file.hpp"
#include "experiments/files/json_node.hpp"
#include "experiments/files/parameter_file.hpp"
#include "experiments/progress.hpp"
#include "experiments/scenes/scene_set.hpp"
#include "experiments/tuning/tuner.hpp"
#include "model/invalid_input.hpp"

#include <algorithm>
#include <array>
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

/// Sums of values over scenes by rate.
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

double share(const LapFigure& sums) {
    return sums.scenes == 0 ? 0.0 : sums.sum / static_cast<double>(sums.scenes);
}

double mean_of_others(const HeldOut& fold, std::vector<LapFigure> laps) {
    std::erase_if(laps, [&](const LapFigure& lap) { return holds_out(fold, lap.track); });
    return mean_over_scenes(laps);
}

SceneSet scenes_with(const ExtraKnowledge& knowledge, const ExtrasOptions& options) {
    SceneOptions scenes = options.scenes;
    scenes.with_confidence = knowledge.confidence;
    scenes.with_color = knowledge.color_error.has_value();
    scenes.color_error_rate = knowledge.color_error.value_or(0.0);
    return make_scene_set(options.tracks, scenes);
}

Evaluation evaluation_of(const SceneSet& set, TuningObjective objective, const ExtrasOptions& options) {
    EvaluationOptions evaluation = options.evaluation;
    evaluation.objective = objective;
    return {set, evaluation};
}

void require_held_out_tracks(const SceneSet& set, const ExtrasOptions& options) {
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

/// The fold's parameters under each weight of what is known.
std::vector<RldParameters> choices(const ExtraKnowledge& knowledge, const HeldOut& fold,
                                   const ExtrasOptions& options) {
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

std::vector<ExtrasRow> rows_with(const ExtraKnowledge& knowledge, const ExtrasOptions& options,
                                 Progress& progress) {
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
    std::vector<ExtrasRow> rows;
    for (const auto& [rate, sums] : accurate) {
        rows.push_back({knowledge, rate, sums.scenes, share(sums), share(successful[rate]), chosen});
    }
    return rows;
}

}  // namespace

ExtrasOptions read_tuning_record(const std::filesystem::path& file) {
    ExtrasOptions options;
    with_json_file(file, [&](const JsonNode& json) {
        options.tracks = strings_of(json.member("tracks"));
        SceneOptions& scenes = options.scenes;
        scenes.false_positive_rates = numbers_of(json.member("fp"));
        scenes.ranges_m = numbers_of(json.member("range"));
        scenes.every_m = json.member("every").number();
        scenes.noise_sigma_m = json.member("noise").number();
        const JsonNode pose_noise = json.member("pose_noise");
        if (pose_noise.array_size() != 2) pose_noise.fail("must be two numbers");
        scenes.pose_noise_lateral_m = pose_noise.element(0).number();
        scenes.pose_noise_yaw_rad = pose_noise.element(1).number();
        scenes.miss_rate = json.member("miss").number();
        scenes.seed = json.member("seed").unsigned_integer();
        options.evaluation.time_limit_ms = json.member("time_limit_ms").non_negative_number();
        options.evaluation.most_nodes = json.member("most_nodes").non_negative_integer();
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

std::string to_string(const ExtraKnowledge& knowledge) {
    std::vector<std::string> parts;
    if (knowledge.confidence) parts.emplace_back("confidences");
    if (knowledge.color_error) {
        parts.push_back(*knowledge.color_error == 0.0
                            ? "right colours"
                            : fmt::format("colours, {:g} % wrong", 100.0 * *knowledge.color_error));
    }
    return parts.empty() ? "geometry alone" : fmt::format("{}", fmt::join(parts, ", "));
}

std::vector<ExtrasRow> extras_rows(const ExtrasOptions& options) {
    std::vector<ExtraKnowledge> all{{}, {.confidence = true, .color_error = {}}};
    for (const double error : options.color_errors)
        all.push_back({.confidence = false, .color_error = error});
    const std::size_t evaluations =
        1 + options.benefits.size() + options.color_errors.size() * options.color_weights.size();
    Progress progress("extras", options.folds.size() * evaluations);
    std::vector<ExtrasRow> rows;
    for (const ExtraKnowledge& knowledge : all) {
        std::ranges::move(rows_with(knowledge, options, progress), std::back_inserter(rows));
    }
    return rows;
}

std::string extras_table(std::span<const ExtrasRow> rows) {
    std::string table = fmt::format("{:<20} {:>5} {:>7} {:>10} {:>9}  {}\n", "known", "fp %", "scenes",
                                    "accurate %", "success %", "w_b or w_color by fold");
    for (const ExtrasRow& row : rows) {
        table += fmt::format("{:<20} {:>5.1f} {:>7} {:>10.1f} {:>9.1f}  {}\n", to_string(row.knowledge),
                             100.0 * row.false_positive_rate, row.scenes, 100.0 * row.accurate,
                             100.0 * row.success,
                             row.weights.empty() ? "-" : fmt::format("{}", fmt::join(row.weights, " ")));
    }
    return table;
}

void write_extras_rows(const std::filesystem::path& file, std::span<const ExtrasRow> rows,
                       const ExtrasOptions& options) {
    FigureFile output(file);
    for (const ExtrasRow& row : rows) {
        nlohmann::ordered_json json{{"known", to_string(row.knowledge)},
                                    {"confidence", row.knowledge.confidence}};
        if (row.knowledge.color_error) json["color_error"] = *row.knowledge.color_error;
        json["false_positive_rate"] = row.false_positive_rate;
        json["scenes"] = row.scenes;
        json["accurate"] = row.accurate;
        json["success"] = row.success;
        if (!row.weights.empty()) json["weights"] = row.weights;
        if (options.evaluation.nearest) json["nearest"] = *options.evaluation.nearest;
        if (options.evaluation.context) json["context"] = *options.evaluation.context;
        output.add(std::move(json));
    }
    output.commit();
}

}  // namespace conelane::experiments
