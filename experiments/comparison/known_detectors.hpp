#pragma once

#include "detectors/recipe.hpp"
#include "evaluation/outside/outside_method.hpp"

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace conelane::experiments {

/// What is compared: the detectors of the library, and what exists only to be compared with them.
struct Method : DetectorRecipe {
    bool is_ablation = false;  ///< a part of another method left out, or printed as it would not be used
};

/// All methods of this build, those of the library first.
[[nodiscard]] std::span<const Method> methods();

/// Throws InvalidInput naming the method where there is none of that name.
[[nodiscard]] const Method& find_method(std::string_view name);

/// As `parse_outside_method`. Throws InvalidInput too where the name is that of a method of this program.
[[nodiscard]] std::optional<OutsideMethod> find_outside_method(std::string_view text);

}  // namespace conelane::experiments
