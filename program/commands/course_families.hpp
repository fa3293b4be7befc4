#pragma once

#include "experiments/cross_validation/course_family.hpp"

#include <string>
#include <vector>

namespace conelane::experiments {

/// The families that a user lists as NAME=SPEC, in the order in which their names first occur; another SPEC
/// with the same name is added to that family. Throws CLI::ValidationError naming a text of another form.
[[nodiscard]] std::vector<CourseFamily> parse_families(const std::vector<std::string>& texts);

}  // namespace conelane::experiments
