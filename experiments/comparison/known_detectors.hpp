#pragma once

#include "detectors/recipe.hpp"
#include "evaluation/outside/outside_detector.hpp"

#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace conelane::experiments {

/// A detector for comparisons: one of the library, or one that exists only to be compared with them.
struct KnownDetector : DetectorRecipe {
    bool is_ablation = false;  ///< another detector without a part, or as its paper prints it
};

/// All detectors of this build, those of the library first.
[[nodiscard]] std::span<const KnownDetector> known_detectors();

/// Throws InvalidInput naming the detector if there is none of that name.
[[nodiscard]] const KnownDetector& find_detector(std::string_view name);

/// The courses that the detector of that name has learned from; empty if it has learned from none, or if
/// there is no such detector.
[[nodiscard]] std::set<std::string> training_courses(std::string_view name);

/// Like `parse_outside_detector`. Throws InvalidInput also if the name belongs to a detector of this program.
[[nodiscard]] std::optional<OutsideDetector> find_outside_detector(std::string_view text);

}  // namespace conelane::experiments
