#pragma once

#include "graph_search/clc/lane_beam.hpp"

#include <string>
#include <string_view>

namespace conelane {

/// Scores from their file: a JSON object with `version` 1 and `measures`, which has an object for each of
/// step_measures(), in its order: `first` and `spacing`, as the program has them, and `scores`. Other keys,
/// such as `training`, say where they come from. Throws InvalidInput naming the key.
[[nodiscard]] StepScores parse_step_scores(std::string_view json);

/// The file, such that parse_step_scores gives the same scores to the last bit. `training`: a JSON object.
/// Throws InvalidInput if the scores are invalid or `training` is not JSON.
[[nodiscard]] std::string step_scores_json(const StepScores& scores, std::string_view training);

/// The `training` of such a file. Throws as parse_step_scores, but reads only this part.
[[nodiscard]] std::string step_scores_training(std::string_view json);

/// The file of the scores that come with the library.
[[nodiscard]] std::string_view shipped_step_score_file();

}  // namespace conelane
