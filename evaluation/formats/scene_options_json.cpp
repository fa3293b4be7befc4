#include "evaluation/formats/scene_options_json.hpp"

namespace conelane {

nlohmann::ordered_json scene_options_json(const SceneOptions& options) {
    nlohmann::ordered_json json{
        {"fp", options.false_positive_rates},
        {"range", options.ranges_m},
        {"every", options.every_m},
        {"noise", options.noise_sigma_m.value_or(0.0)},
        {"pose_noise",
         {options.pose_noise_lateral_m.value_or(0.0), options.pose_noise_yaw_rad.value_or(0.0)}},
        {"miss", options.miss_rate.value_or(0.0)},
        {"color", options.with_color},
        {"color_error", options.color_error_rate},
        {"color_unknown", options.color_unknown_rate},
        {"confidence", options.with_confidence},
        {"seed", options.seed}};
    if (!options.conditions.empty()) json["condition"] = condition_names(options);
    if (options.noise_by_range) json["noise_by_range"] = *options.noise_by_range;
    if (options.persistent) json["persist"] = *options.persistent;
    if (options.nearest) json["nearest"] = *options.nearest;
    return json;
}

}  // namespace conelane
