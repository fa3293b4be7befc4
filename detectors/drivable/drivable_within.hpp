#pragma once

#include "conelane/drivable_lane.hpp"
#include "model/deadline.hpp"

#include <optional>

namespace conelane {

/// The same as `drivable`; nothing if the deadline passes first. The deadline is checked at least every half
/// millisecond for lanes of up to a kilometre.
[[nodiscard]] std::optional<DrivableLane> drivable_within(const Lane& lane, const Scene& scene,
                                                          const DrivableOptions& options,
                                                          const Deadline& deadline);

}  // namespace conelane
