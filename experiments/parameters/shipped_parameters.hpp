#pragma once

#include "model/rld_parameters.hpp"

#include <optional>
#include <string_view>
#include <vector>

namespace conelane::experiments {

/// Tuned parameters that are part of the program: `n12` for the accuracy of lanes among the 12 nearest cones,
/// `full` for the IoU of lanes among all that is visible at 30 m, `topologies` as `n12` on generated
/// straights, circles and curvy tracks, the topologies of the RLD paper's Fig. 7. NAME.record.json beside
/// NAME.json says on which scenes they were found and, for the first two, what the same search gave on tracks
/// held out from it: `n12` gains 6.5 points at 50 % false positives and 0.9 at 16.7 %, and loses 0.9 without
/// any; `full` is worse without any. `topologies` is worse than the defaults on recorded tracks. So none is
/// the default.
[[nodiscard]] std::vector<std::string_view> shipped_rld_parameter_names();

/// The set of that name; nothing where there is none.
[[nodiscard]] std::optional<RldParameters> shipped_rld_parameters(std::string_view name);

}  // namespace conelane::experiments
