#pragma once

#include "evaluation/world/scene_options.hpp"

#include <type_traits>
#include <vector>

#include <nlohmann/json.hpp>

namespace conelane {

/// The options that scenes depend on beside their tracks, for the record of a run, a training or a tuning;
/// keys as on the command line. `condition`, `persist` and `nearest` are present only if they were given.
[[nodiscard]] nlohmann::ordered_json scene_options_json(const SceneOptions& options);

/// The options as records have them: their conditions by the names that the other options change.
[[nodiscard]] SceneOptions as_recorded(SceneOptions options);

/// The fields of a record, see json_fields.hpp.
template <typename Options, typename Fields>
void scene_fields(Options& options, Fields& fields) {
    constexpr bool kIsRead = !std::is_const_v<Options>;
    const auto or_zero = [&](const char* key, auto& value) {
        double number = value.value_or(0.0);
        fields(key, number);
        if constexpr (kIsRead) value = number;
    };
    fields("fp", options.false_positive_rates);
    fields("range", options.ranges_m);
    fields("every", options.every_m);
    or_zero("noise", options.noise_sigma_m);
    std::vector<double> pose{options.pose_noise_lateral_m.value_or(0.0),
                             options.pose_noise_yaw_rad.value_or(0.0)};
    fields("pose_noise", pose);
    if constexpr (kIsRead) {
        options.pose_noise_lateral_m = pose.empty() ? 0.0 : pose.front();
        options.pose_noise_yaw_rad = pose.empty() ? 0.0 : pose.back();
    }
    or_zero("miss", options.miss_rate);
    fields("color", options.with_color);
    fields("color_error", options.color_error_rate);
    fields("color_unknown", options.color_unknown_rate);
    fields("confidence", options.with_confidence);
    fields("seed", options.seed);
    fields.maybe("condition", options.conditions);
    fields.maybe("noise_by_range", options.noise_by_range);
    fields.maybe("persist", options.persistent);
    fields.maybe("nearest", options.nearest);
}

}  // namespace conelane
