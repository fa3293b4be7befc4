#pragma once

#include "experiments/cross_check/drawn_case.hpp"

#include <cstddef>
#include <functional>

namespace conelane::experiments {

/// The case with as many cones removed, and as many parameters at their defaults, as `differs` allows: it
/// holds for the result, and not after any further cone is removed. It is called at most `max_trials` times.
/// Precondition: it holds for `drawn`.
[[nodiscard]] CrossCheckCase shrink(CrossCheckCase drawn,
                                    const std::function<bool(const CrossCheckCase&)>& differs,
                                    std::size_t max_trials = 2000);

}  // namespace conelane::experiments
