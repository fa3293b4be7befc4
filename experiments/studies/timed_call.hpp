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
    /// Throws InvalidInput naming the scene where the answer of a detector or of an exact solver is an error.
    std::function<void(const Scene& scene, double time_limit_ms)> run;
};

/// The detectors of these names; what is the name of no detector is that of a solver of the registry, on all
/// cones with the default parameters and the tight formulation. Throws InvalidInput naming what is neither.
[[nodiscard]] std::vector<TimedCall> timed_calls(std::span<const std::string> names);

}  // namespace conelane::experiments
