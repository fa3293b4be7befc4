#pragma once

#include "conelane/lane_detector.hpp"

#include <limits>

namespace conelane::tests {

/// For tests of what is found, however slow the machine is.
inline constexpr DetectionLimits kNoTimeLimit{.time_limit_ms = std::numeric_limits<double>::infinity()};

}  // namespace conelane::tests
