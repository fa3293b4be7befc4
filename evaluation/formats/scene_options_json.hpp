#pragma once

#include "evaluation/world/scene_options.hpp"

#include <nlohmann/json.hpp>

namespace conelane {

/// The options that scenes depend on beside their tracks, for the record of a run, a training or a tuning;
/// keys as on the command line. `condition`, `persist` and `nearest` are present only if they were given.
[[nodiscard]] nlohmann::ordered_json scene_options_json(const SceneOptions& options);

}  // namespace conelane
