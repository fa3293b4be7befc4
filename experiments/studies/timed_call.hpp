#pragma once

#include "conelane/scene.hpp"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

/// One call of a detector or of a solver on a scene, under a limit of wall clock.
struct TimedCall {
    std::string name;
    /// Throws InvalidInput naming the scene if the answer of a detector or of an exact solver is an error.
    std::function<void(const Scene& scene, double time_limit_ms)> run;
};

/// The detectors of these names. Any other name is that of a solver of the registry, on all cones with the
/// default parameters and the tight formulation. Throws InvalidInput naming a name that is neither.
[[nodiscard]] std::vector<TimedCall> timed_calls(std::span<const std::string> names);

}  // namespace conelane::experiments
