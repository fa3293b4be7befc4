#pragma once

#include "model/rld_parameters.hpp"

#include <optional>
#include <string_view>
#include <vector>

namespace conelane::experiments {

/// Tuned parameters that are part of the program: `context` for the accuracy of lanes among the 12 nearest
/// cones that are found among 24 (the method rld-context), `shape` for the same with the costs of the lane's
/// shape (rld-shape-context), `n12` for that of lanes found among the 12 alone,
/// `full` for the IoU of lanes among all that is visible at 30 m, `topologies` as `n12` on generated
/// straights, circles and curvy tracks, the topologies of the RLD paper's Fig. 7. NAME.record.json beside
/// NAME.json says on which scenes they were found and, but for `topologies`, what the same search gave on
/// tracks held out from it. At 0, 16.7 and 50 % false positives 98.4, 95.4 and 83.0 % are accurate by
/// `context`, 97.5, 94.0 and 74.8 % by the defaults in that context; 98.5, 97.1 and 90.1 % by `shape`, 97.0,
/// 96.0 and 89.7 % by the hand-set weights of its costs; without context 96.6, 92.6 and 72.3 % by
/// `n12`, 97.5, 91.7 and 65.8 % by the defaults. At 0 and 30 % the IoU of `full` is 98.4 and 94.8 %, that of
/// the defaults 98.9 and 93.3 %. `topologies` is worse than the defaults on recorded tracks. So none is the
/// default.
[[nodiscard]] std::vector<std::string_view> shipped_rld_parameter_names();

/// The set of that name; nothing where there is none.
[[nodiscard]] std::optional<RldParameters> shipped_rld_parameters(std::string_view name);

}  // namespace conelane::experiments
