#pragma once

#include "experiments/cross_validation/course_family.hpp"

#include <string>
#include <vector>

namespace conelane::experiments {

/// The families that a user lists as NAME=SPEC, in the order in which their names come first; a name that is
/// there already gets another SPEC. Throws CLI::ValidationError naming the text that is no such thing.
[[nodiscard]] std::vector<CourseFamily> parse_families(const std::vector<std::string>& texts);

}  // namespace conelane::experiments
