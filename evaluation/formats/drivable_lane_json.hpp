#pragma once

#include "conelane/drivable_lane.hpp"

#include <nlohmann/json_fwd.hpp>

namespace conelane {

/// Adds `trusted_m` and `inferred` if they are known, `bridged` and `points` to an object.
void put_drivable_lane(nlohmann::ordered_json& json, const DrivableLane& lane);

}  // namespace conelane
