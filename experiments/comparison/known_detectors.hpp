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

/// What is compared: the detectors of the library, and what exists only to be compared with them.
struct KnownDetector : DetectorRecipe {
    bool is_ablation = false;  ///< a part of another detector left out, or printed as it would not be used
};

/// All detectors of this build, those of the library first.
[[nodiscard]] std::span<const KnownDetector> known_detectors();

/// Throws InvalidInput naming the detector where there is none of that name.
[[nodiscard]] const KnownDetector& find_detector(std::string_view name);

/// The courses that the detector of that name has learned from; empty where it has seen none, or there is no
/// such detector.
[[nodiscard]] std::set<std::string> training_courses(std::string_view name);

/// As `parse_outside_detector`. Throws InvalidInput too where the name is that of a detector of this program.
[[nodiscard]] std::optional<OutsideDetector> find_outside_detector(std::string_view text);

}  // namespace conelane::experiments
