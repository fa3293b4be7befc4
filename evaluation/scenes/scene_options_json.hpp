#pragma once

#include "evaluation/scenes/scene_options.hpp"

#include <nlohmann/json.hpp>

namespace conelane {

/// What scenes depend on beside their tracks, for the record of a run, a training or a tuning; keys as the
/// options of the command line. `condition`, `persist` and `nearest` are there only where they were given.
[[nodiscard]] nlohmann::ordered_json scene_options_json(const SceneOptions& options);

}  // namespace conelane
