#include "learning/tuning/detector_tuning.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/progress/parallel.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/seeded_random.hpp"
#include "learning/tuning/parameter_ranges.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <fmt/format.h>

namespace conelane::learning {
namespace {

/// Share of the evaluations that cover the whole ranges, and the steps of the others as shares of a range.
constexpr double kEverywhere = 0.4;
constexpr double kFirstStep = 0.25;
constexpr double kLastStep = 0.025;
/// Share of the parameters that one step changes.
constexpr double kMovedShare = 0.4;

/// Four significant digits: short numbers in files, and the same on every machine, although logarithms differ
/// in the last bits.
double short_value(double value) {
    return value == 0.0 ? 0.0 : std::stod(fmt::format("{:.4g}", value));
}

/// The value at a share of the range.
double at(const TunableParameter& parameter, double share) {
    return std::clamp(short_value(value_at(parameter, std::clamp(share, 0.0, 1.0))), parameter.lowest,
                      parameter.highest);
}

std::vector<double> anywhere(std::span<const TunableParameter> parameters,
                             boost::random::mt19937_64& random) {
    boost::random::uniform_01<double> uniform;
    std::vector<double> values;
    for (const TunableParameter& parameter : parameters) values.push_back(at(parameter, uniform(random)));
    return values;
}

/// Changes some of the values, at least one, by about `step` of their ranges.
std::vector<double> nearby(std::span<const TunableParameter> parameters, std::vector<double> values,
                           double step, boost::random::mt19937_64& random) {
    boost::random::uniform_01<double> uniform;
    boost::random::normal_distribution<double> normal(0.0, step);
    const std::size_t always =
        boost::random::uniform_int_distribution<std::size_t>(0, values.size() - 1)(random);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const bool moved = uniform(random) < kMovedShare || i == always;
        const double change = normal(random);
        if (moved) values[i] = at(parameters[i], share_of(parameters[i], values[i]) + change);
    }
    return values;
}

}  // namespace

DetectorFigure evaluate(const DetectorRecipe& recipe, std::span<const double> values, const SceneSet& set,
                        unsigned threads) {
    std::vector<SceneScore> scores(set.scenes.size());
    in_parallel(
        set.scenes.size(), threads, [&] { return recipe.tuned()->make(values); },
        [&](std::unique_ptr<LaneDetector>& made, std::size_t i) {
            const AnnotatedScene& scene = set.scenes[i];
            if (!counts(scene)) return;
            made->reset();
            const LaneAnswer answer =
                made->detect(scene.scene, {.time_limit_ms = std::numeric_limits<double>::infinity()});
            scores[i] = score(scene, answer, 0.0, std::nullopt, &set.tracks.at(scene.track));
        });
    DetectorFigure figure;
    for (std::size_t i = 0; i < scores.size(); ++i) {
        if (!counts(set.scenes[i])) continue;
        ++figure.scenes;
        figure.usable += scores[i].usable().value_or(false) ? 1.0 : 0.0;
        figure.iou += scores[i].iou.value_or(0.0);
    }
    if (figure.scenes == 0) throw InvalidInput("--tracks", "no scene has a ground truth");
    figure.usable /= static_cast<double>(figure.scenes);
    figure.iou /= static_cast<double>(figure.scenes);
    return figure;
}

TuningResult tune_detector(const DetectorRecipe& recipe, const SceneSet& set,
                           const DetectorTuningOptions& options, const std::function<void()>& advance) {
    boost::random::mt19937_64 random = generator_of(std::string(recipe.name), options.seed);
    const std::vector<TunableParameter> parameters = recipe.tuned()->parameters();
    TuningResult best;
    best.values = options.start;
    if (best.values.empty())
        std::ranges::transform(parameters, std::back_inserter(best.values), &TunableParameter::start);
    best.figure = best.figure_of_start = evaluate(recipe, best.values, set, options.threads);
    if (advance) advance();
    const auto everywhere = static_cast<std::size_t>(kEverywhere * static_cast<double>(options.evaluations));
    for (std::size_t i = 1; i < options.evaluations; ++i) {
        const double progress = i < everywhere ? 0.0
                                               : static_cast<double>(i - everywhere) /
                                                     static_cast<double>(options.evaluations - everywhere);
        const double step = kFirstStep * std::pow(kLastStep / kFirstStep, progress);
        std::vector<double> values =
            i < everywhere ? anywhere(parameters, random) : nearby(parameters, best.values, step, random);
        const DetectorFigure figure = evaluate(recipe, values, set, options.threads);
        if (figure.value() > best.figure.value()) {
            best.values = std::move(values);
            best.figure = figure;
        }
        if (advance) advance();
    }
    return best;
}

std::string to_json_text(const DetectorRecipe& recipe, std::span<const double> values) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    auto value = values.begin();
    for (const TunableParameter& parameter : recipe.tuned()->parameters())
        json[std::string(parameter.key)] = *value++;
    return json.dump(2) + "\n";
}

std::vector<double> parse_values(const DetectorRecipe& recipe, std::string_view text,
                                 const std::filesystem::path& file) {
    std::vector<double> values;
    std::vector<std::string_view> keys;
    with_json_text(text, file, [&](const JsonNode& json) {
        for (const TunableParameter& parameter : recipe.tuned()->parameters()) {
            values.push_back(json.member(parameter.key).number_in(parameter.lowest, parameter.highest));
            keys.push_back(parameter.key);
        }
        require_known_keys(json, keys);
    });
    return values;
}

}  // namespace conelane::learning
