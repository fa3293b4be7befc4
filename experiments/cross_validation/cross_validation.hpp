#pragma once

#include "experiments/comparison/comparison.hpp"

namespace conelane::experiments {

/// Courses of one place or one designer, so similar that a method that has seen one of them knows the others.
struct CourseFamily {
    std::string name;                 ///< of its folder
    std::vector<std::string> tracks;  ///< SPECs of load_tracks
};

/// The families that a user lists as NAME=SPEC, in the order in which their names first occur; another SPEC
/// with the same name is added to that family. Throws InvalidInput naming a text of another form.
[[nodiscard]] std::vector<CourseFamily> parse_families(const std::vector<std::string>& texts);

/// Throws InputError naming a file in the folder of learned files whose training record has one of these
/// courses, which are held out. Files without a record are not checked.
void require_held_out(const std::set<std::string>& courses, const std::filesystem::path& fold);

struct CrossValidationOptions {
    std::vector<CourseFamily> families;  ///< at least two; each is held out once
    std::vector<std::string> always;     ///< SPECs of tracks that every fold learns from; none is scored
    LearningOptions learning;            ///< its tracks are those of a fold
    /// Learned files FOLDER/FAMILY/... of another cross-validation with the same families; empty: learn.
    std::filesystem::path folds;
    /// FOLDER/FAMILY/... of another cross-validation with the same families, whose scenes had no colors:
    /// `front` learns its set for colors, `rld-shape` its weight of colors, and `rld-learned` goes on with
    /// all costs. Empty: everything is learned from the beginning. Only for scenes with colors.
    std::filesystem::path colors_from;
    /// The methods, the scenes on which they are scored, and how they are run. Its tracks are those of the
    /// families.
    ComparisonOptions comparison;
};

/// A comparison in which no detector has seen a course that it is scored on. For each family, the detectors
/// that learn do so on all other families and `always`, then drive the courses of the family; other detectors
/// drive them unchanged. Writes the files of `compare` to the directory, and learned files to folds/FAMILY/
/// in it. With `folds` nothing is learned, and the record has hashes of the files. A stopped run resumes.
/// Returns the table. Throws InputError or InvalidInput, also if a course belongs to two families, or to a
/// family and to `always`, if a learned file is missing or has learned from the courses it is for, or if a
/// detector with `colors_from` ignores colors.
[[nodiscard]] ComparisonOutcome cross_validate(const CrossValidationOptions& options,
                                               const std::filesystem::path& directory);

}  // namespace conelane::experiments
