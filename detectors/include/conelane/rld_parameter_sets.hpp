#pragma once

#include "conelane/rld_parameters.hpp"

#include <optional>
#include <string_view>
#include <vector>

namespace conelane {

/// Parameter sets of the library, and what each was tuned for:
/// - `context`: accuracy of lanes of the 12 nearest cones, searched among 24 (the cones of rld-context),
/// - `shape`: the same with the costs of the lane's shape,
/// - `n12`: accuracy of lanes searched among the 12 nearest cones,
/// - `full`: IoU of lanes searched among all visible cones at 30 m,
/// - `learned`: lanes of all visible cones, by learned costs alone (the detector rld-learned); its weights
///   file contains its record.
///
/// For the other sets, detectors/parameters/NAME.record.json has the scenes of the tuning and the figures on
/// held-out tracks. No set is better everywhere: of the detectors only rld-learned has one by default.
[[nodiscard]] std::vector<std::string_view> rld_parameter_set_names();

/// The set of that name; nothing for an unknown name.
[[nodiscard]] std::optional<RldParameters> rld_parameter_set(std::string_view name);

}  // namespace conelane
