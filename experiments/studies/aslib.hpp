#pragma once

#include "experiments/studies/solve_rows.hpp"

#include <filesystem>
#include <span>

namespace conelane::experiments {

/// Writes a scenario of the algorithm selection library ASlib (format 4.0) into the folder: description.txt,
/// algorithm_runs.arff, feature_values.arff, feature_runstatus.arff, feature_costs.arff and cv.arff. An
/// instance is a scene at a size, "SCENE n=12"; an algorithm is a backend without a start; a repetition is
/// one of its orders, 1 is the original one. Times are seconds of wall clock. Folds: all scenes of a track in
/// one, at most ten. Features are computed on this machine (see InstanceFeatures), without the gap of the
/// relaxation. All files appear or none. Throws InputError if the folder cannot be made or written,
/// InvalidInput if there is no row.
void write_aslib_scenario(const std::filesystem::path& folder, std::span<const SolveRow> rows,
                          const SolveOptions& options);

}  // namespace conelane::experiments
