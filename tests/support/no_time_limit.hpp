#pragma once

#include "conelane/lane_detector.hpp"

#include <limits>

namespace conelane::tests {

/// For tests of answers, which must not depend on the speed of the machine.
inline constexpr DetectionLimits kNoTimeLimit{.time_limit_ms = std::numeric_limits<double>::infinity()};

}  // namespace conelane::tests
