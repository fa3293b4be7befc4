#pragma once

#include "detectors/recipe.hpp"
#include "evaluation/formats/scene_set.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace conelane::learning {

/// Figures of values on scenes. More often usable is better; if equal, higher IoU is better.
struct DetectorFigure {
    std::size_t scenes = 0;
    double usable = 0.0;  ///< share of the scenes
    double iou = 0.0;     ///< mean

    /// The objective of tuning: the share usable plus a tenth of the mean IoU, which guides the search where
    /// a share of a few hundred scenes does not change.
    [[nodiscard]] double value() const { return usable + 0.1 * iou; }
};

/// Answers every scene that counts by the tuned detector of these values, without a limit of time. The same
/// for any number of threads.
[[nodiscard]] DetectorFigure evaluate(const DetectorRecipe& recipe, std::span<const double> values,
                                      const SceneSet& set, unsigned threads);

struct DetectorTuningOptions {
    std::size_t evaluations = 100;  ///< at least one, the start
    std::uint64_t seed = 0;
    unsigned threads = 1;
    std::vector<double> start = {};  ///< empty: the values set by hand
};

struct TuningResult {
    std::vector<double> values;  ///< four significant digits
    DetectorFigure figure;
    DetectorFigure figure_of_start;
};

/// Random search: the start, then points drawn uniformly from the ranges for two fifths of the evaluations,
/// then points around the best so far in steps that shrink from a quarter of each range to a fortieth. The
/// best point evaluated is the answer. The same scenes, seed and options give the same answer. `advance` is
/// called after each evaluation. Precondition: the detector is tuned.
[[nodiscard]] TuningResult tune_detector(const DetectorRecipe& recipe, const SceneSet& set,
                                         const DetectorTuningOptions& options,
                                         const std::function<void()>& advance = {});

/// The parameter file of a tuned detector: one flat JSON object with a number for each parameter.
[[nodiscard]] std::string to_json_text(const DetectorRecipe& recipe, std::span<const double> values);
/// The values in such a text. Throws InputError naming file and key if one is missing or out of its range.
[[nodiscard]] std::vector<double> parse_values(const DetectorRecipe& recipe, std::string_view text,
                                               const std::filesystem::path& file);

}  // namespace conelane::learning
