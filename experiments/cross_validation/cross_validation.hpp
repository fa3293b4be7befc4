#pragma once

#include "experiments/comparison/comparison.hpp"
#include "experiments/cross_validation/course_family.hpp"
#include "experiments/cross_validation/learners.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace conelane::experiments {

struct CrossValidationOptions {
    std::vector<CourseFamily> families;  ///< at least two; each is held out once
    std::vector<std::string> always;     ///< SPECs that every fold learns from, and none is scored on
    LearningOptions learning;            ///< its tracks are those of a fold
    /// The detectors, the scenes they are scored on, and how they are run. Its tracks are those of the
    /// families.
    ComparisonOptions comparison;
};

/// A comparison in which no detector has seen a course that it is scored on: for each family, what learns
/// does so on all others and `always`, then drives the courses of the family; a detector that learns nothing
/// drives them as it is. Writes what `compare` writes to the directory, and what was learned to folds/FAMILY/
/// below it. A run that was stopped goes on. Returns the table. Throws InputError or InvalidInput, so where a
/// course belongs to two families, or to one and to those always learned from.
[[nodiscard]] ComparisonOutcome cross_validate(const CrossValidationOptions& options,
                                               const std::filesystem::path& directory);

}  // namespace conelane::experiments
