#pragma once

#include "evaluation/world/annotated_scene.hpp"

#include <cstddef>
#include <vector>

namespace conelane::experiments {

/// The scenes of the file that the environment variable CONELANE_SCENES names. Without it, those of the
/// generated tracks, a pose every 15 m, 30 m of range. Throws InputError if the file is invalid.
[[nodiscard]] std::vector<AnnotatedScene> benchmark_scenes(double false_positive_rate);

/// The scenes with at least this many cones ahead, with only the nearest of them.
[[nodiscard]] std::vector<Scene> scenes_of_size(const std::vector<AnnotatedScene>& all, std::size_t size);

}  // namespace conelane::experiments
