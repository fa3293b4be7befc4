#pragma once

#include "model/rld_parameters.hpp"

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace conelane::experiments {

/// Up to this cone-set size the set `n12` is the default.
inline constexpr std::size_t kLargestSmallConeSet = 20;

/// Tuned parameters that are part of the program: `n12` for the accuracy of lanes among the 12 nearest cones,
/// `full` for the IoU of lanes among all that is visible at 30 m. NAME.record.json beside NAME.json says on
/// which scenes they were found, and what the same search gave on tracks held out from it.
[[nodiscard]] std::vector<std::string_view> shipped_rld_parameter_names();

/// The set of that name; nothing where there is none.
[[nodiscard]] std::optional<RldParameters> shipped_rld_parameters(std::string_view name);

/// The default for a cone-set size (absent: all cones), by what the records say of held-out tracks: `n12` up
/// to kLargestSmallConeSet cones, RldParameters{} beyond, since `full` was worse than it there, above all
/// without false positives.
[[nodiscard]] RldParameters shipped_rld_parameters(std::optional<std::size_t> cone_set_size);

}  // namespace conelane::experiments
