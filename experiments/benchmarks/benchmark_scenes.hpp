#pragma once

#include "evaluation/world/annotated_scene.hpp"

#include <functional>
#include <memory>

namespace conelane::experiments {

/// The scenes of the file that the environment variable CONELANE_SCENES names. Without it, those of the
/// generated tracks, a pose every 15 m, 30 m of range. Throws InputError if the file is invalid.
[[nodiscard]] std::vector<AnnotatedScene> benchmark_scenes(double false_positive_rate);

/// The scenes with at least this many cones ahead, with only the nearest of them.
[[nodiscard]] std::vector<Scene> scenes_of_size(const std::vector<AnnotatedScene>& all, std::size_t size);

using SharedScenes = std::shared_ptr<const std::vector<AnnotatedScene>>;

/// Registers benchmarks on benchmark_scenes and runs all. Returns the program's exit code.
[[nodiscard]] int run_benchmarks(int argument_count, char** arguments, double false_positive_rate,
                                 const std::function<void(const SharedScenes&)>& register_all);

}  // namespace conelane::experiments
