#pragma once

#include "experiments/studies/backends.hpp"

#include <filesystem>
#include <span>

namespace conelane::experiments {

/// Writes a scenario of the algorithm selection library ASlib (format 4.0) into the folder: description.txt,
/// algorithm_runs.arff, feature_values.arff, feature_runstatus.arff, feature_costs.arff and cv.arff. An
/// instance is a scene at a size, "SCENE n=12"; an algorithm is a backend from nothing; a repetition is one
/// of its orders, 1 as it stands. Times are seconds of wall clock. Folds: all scenes of a track in one, ten
/// at most. Features are computed here, on this machine (see InstanceFeatures), the gap of the relaxation is
/// none. All files appear or none. Throws InputError where the folder cannot be made or written, InvalidInput
/// where there is no row.
void write_aslib_scenario(const std::filesystem::path& folder, std::span<const BackendRow> rows,
                          const BackendOptions& options);

}  // namespace conelane::experiments
