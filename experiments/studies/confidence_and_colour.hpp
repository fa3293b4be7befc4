#pragma once

#include "conelane/rld_parameters.hpp"
#include "evaluation/world/scene_generation.hpp"
#include "experiments/tuning/evaluation.hpp"
#include "experiments/tuning/parameter_ranges.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace conelane::experiments {

/// Tracks that a fit has not seen, and what it found on the others.
struct HeldOut {
    std::vector<std::string> tracks;
    RldParameters parameters;
};

/// The scenes and folds of a tuning whose parameters were fitted to geometry only, and the simulated data on
/// them. In each fold, the weight w_b (with confidences, which lower it) and the weight w_color (with colors)
/// are those that are most accurate on the tracks that are not held out; of equal ones the smallest.
struct ConfidenceColorOptions {
    std::vector<std::string> tracks;  ///< as in make_scene_set
    SceneOptions scenes;
    EvaluationOptions evaluation;  ///< its objective is without effect
    std::vector<HeldOut> folds;
    std::vector<std::string> only;  ///< tracks to report; all held-out ones if empty
    std::vector<double> color_errors{0.0, 0.05, 0.2};
    std::vector<double> color_weights{kColorWeights.begin(), kColorWeights.end()};  ///< w_color, ascending
    std::vector<double> benefits{1.0, 1.5, 2.0, 2.5, 3.0};                          ///< w_b, ascending
};

/// Scenes, cone set and folds of a record that `conelane tune` has written. Throws InputError if the file is
/// invalid or its tuning held no track out.
[[nodiscard]] ConfidenceColorOptions read_tuning_record(const std::filesystem::path& file);

/// The simulated data beside the geometry: confidences, colors or neither.
struct SimulatedKnowledge {
    bool confidence = false;
    std::optional<double> color_error;  ///< share of wrong colors; absent without colors

    bool operator==(const SimulatedKnowledge&) const = default;
};
[[nodiscard]] std::string to_string(const SimulatedKnowledge& knowledge);

/// One knowledge at one rate of false positives, over the held-out tracks of all folds.
struct ConfidenceColorRow {
    SimulatedKnowledge knowledge;
    double false_positive_rate = 0.0;
    std::size_t scenes = 0;       ///< whose cone set holds a ground truth
    double accurate = 0.0;        ///< share of them (RLD paper, IV-B)
    double success = 0.0;         ///< share of all scenes (CLC paper, Table I)
    std::vector<double> weights;  ///< w_b with confidences, w_color with colors, by fold; empty with neither

    bool operator==(const ConfidenceColorRow&) const = default;
};

/// Rows by knowledge: geometry only, confidences, colors in the order of their errors; then by rate. Throws
/// InvalidInput if a fold holds out a track that has no scene, or none holds out one of `only`.
[[nodiscard]] std::vector<ConfidenceColorRow> confidence_color_rows(const ConfidenceColorOptions& options);

}  // namespace conelane::experiments
