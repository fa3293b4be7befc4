#pragma once

#include "experiments/scenes/scene_generation.hpp"
#include "experiments/tuning/evaluation.hpp"
#include "model/rld_parameters.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

/// Tracks that a fit has not seen, and what it found on the others.
struct HeldOut {
    std::vector<std::string> tracks;
    RldParameters parameters;
};

/// The question measured: what are detection confidences and cone colours worth to RLD (RLD paper, V)?
/// Protocol: the scenes and folds of a tuning, whose parameters were fitted to geometry alone; the same
/// scenes with simulated confidences, with right colours and with shares of wrong ones. Each fold's
/// parameters answer for the tracks that it held out. With confidences the weight w_b, which they lower, and
/// with colours the weight w_color are, in each fold, those that are most accurate on the tracks that are not
/// held out; of equal ones the smallest.
struct ExtrasOptions {
    std::vector<std::string> tracks;  ///< as in make_scene_set
    SceneOptions scenes;
    EvaluationOptions evaluation;  ///< its objective is without effect
    std::vector<HeldOut> folds;
    std::vector<std::string> only;  ///< tracks that rows are of; all held-out ones where empty
    std::vector<double> color_errors{0.0, 0.05, 0.2};
    std::vector<double> color_weights{0.0, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2};  ///< w_color, ascending
    std::vector<double> benefits{1.0, 1.5, 2.0, 2.5, 3.0};                       ///< w_b, ascending
};

/// Scenes, cone set and folds of a record that `conelane tune` has written. Throws InputError where the file
/// is none or its tuning held no track out.
[[nodiscard]] ExtrasOptions read_tuning_record(const std::filesystem::path& file);

/// What is known beside the geometry: one of both or nothing.
struct ExtraKnowledge {
    bool confidence = false;
    std::optional<double> color_error;  ///< share of wrong colours; absent without colours

    bool operator==(const ExtraKnowledge&) const = default;
};
[[nodiscard]] std::string to_string(const ExtraKnowledge& knowledge);

/// One knowledge at one rate of false positives, over the held-out tracks of all folds.
struct ExtrasRow {
    ExtraKnowledge knowledge;
    double false_positive_rate = 0.0;
    std::size_t scenes = 0;       ///< whose cone set holds a ground truth
    double accurate = 0.0;        ///< share of them (RLD paper, IV-B)
    double success = 0.0;         ///< share of all scenes (CLC paper, Table I)
    std::vector<double> weights;  ///< w_b with confidences, w_color with colours, by fold; empty with neither
};

/// Rows by knowledge: geometry alone, confidences, colours in the order of their errors; then by rate. Throws
/// InvalidInput where a fold holds out a track that has no scene, or none holds out one of `only`.
[[nodiscard]] std::vector<ExtrasRow> extras_rows(const ExtrasOptions& options);

/// A table for a terminal, a line per row and a final newline.
[[nodiscard]] std::string extras_table(std::span<const ExtrasRow> rows);

/// A JSON object a line and row, with cone set and commit. Throws InputError where the file cannot be
/// written.
void write_extras_rows(const std::filesystem::path& file, std::span<const ExtrasRow> rows,
                       const ExtrasOptions& options);

}  // namespace conelane::experiments
