#include "evaluation/formats/scene_options_json.hpp"

#include "evaluation/formats/json_fields.hpp"

namespace conelane {

SceneOptions as_recorded(SceneOptions options) {
    if (!options.conditions.empty()) options.conditions = condition_names(options);
    return options;
}

nlohmann::ordered_json scene_options_json(const SceneOptions& options) {
    const SceneOptions recorded = as_recorded(options);
    JsonFieldWriter writer;
    scene_fields(recorded, writer);
    return writer.json;
}

}  // namespace conelane
