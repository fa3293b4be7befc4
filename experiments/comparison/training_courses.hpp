#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>

namespace conelane::experiments {

/// The courses that each weight file of the library was trained on, by the names that tracks have.
[[nodiscard]] const std::map<std::string, std::set<std::string>>& courses_of_weights();

/// The courses that a detector of this program has learned from: its weights were trained on them, or its
/// parameters were set with them in view. Empty where it has seen none.
[[nodiscard]] std::set<std::string> training_courses(std::string_view detector);

}  // namespace conelane::experiments
