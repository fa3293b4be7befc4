#pragma once

#include "conelane/learned_costs.hpp"

#include <string>
#include <string_view>

namespace conelane {

/// The file, such that parse_learned_costs gives the same costs to the last bit; a line for each key.
/// `training`: a JSON object. Throws InvalidInput if the costs are invalid or `training` is not JSON.
[[nodiscard]] std::string learned_costs_json(const LearnedCosts& costs, std::string_view training);

}  // namespace conelane
