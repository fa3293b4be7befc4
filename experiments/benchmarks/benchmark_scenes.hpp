#pragma once

#include "experiments/scenes/annotated_scene.hpp"

#include <vector>

namespace conelane::experiments {

/// The scenes of the file that the environment variable CONELANE_SCENES names. Without it those of the
/// generated tracks, a pose every 15 m, 30 m of range. Throws InputError where the file is not right.
[[nodiscard]] std::vector<AnnotatedScene> benchmark_scenes(double false_positive_rate);

}  // namespace conelane::experiments
