#pragma once

#include "conelane/rld_parameters.hpp"

#include <optional>
#include <string_view>
#include <vector>

namespace conelane {

/// Tuned parameters that are part of the library: `context` for the accuracy of lanes among the 12 nearest
/// cones that are found among 24 (the detector rld-context), `shape` for the same with the costs of the
/// lane's shape (rld-shape-context), `n12` for that of lanes found among the 12 alone, `full` for the IoU of
/// lanes among all that is visible at 30 m. parameters/NAME.record.json says on which scenes they were found
/// and what the same search gave on tracks held out from it. At 0, 16.7 and 50 % false positives 98.4, 95.4
/// and 83.0 % are accurate by `context`, 97.5, 94.0 and 74.8 % by the defaults in that context; 99.5, 97.8
/// and 90.9 % by `shape`, 98.4, 96.7 and 90.9 % by the hand-set weights of its costs; without
/// context 96.6, 92.6 and 72.3 % by `n12`, 97.5, 91.7 and 65.8 % by the defaults. At 0 and 30 % the IoU of
/// `full` is 98.4 and 94.8 %, that of the defaults 98.9 and 93.3 %. So none is the default.
[[nodiscard]] std::vector<std::string_view> rld_parameter_set_names();

/// The set of that name; nothing where there is none.
[[nodiscard]] std::optional<RldParameters> rld_parameter_set(std::string_view name);

}  // namespace conelane
