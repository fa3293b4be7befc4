#pragma once

#include "evaluation/formats/json_records.hpp"
#include "evaluation/world/scene_generation.hpp"

namespace conelane {

/// An option that replaces that of every condition; records have 0 where it is absent.
struct NumberOrZero {
    const char* key;
    std::optional<double> SceneOptions::*value;

    void read(const JsonNode& json, SceneOptions& options) const {
        options.*value = json.member(key).number();
    }
    void put(nlohmann::ordered_json& json, const SceneOptions& options, const std::string& /*place*/) const {
        json[key] = (options.*value).value_or(0.0);
    }
};

/// `pose_noise`: [lateral, yaw].
struct PoseNoise {
    static void read(const JsonNode& json, SceneOptions& options) {
        std::pair<double, double> noise;
        read_value(json.member("pose_noise"), noise);
        options.pose_noise_lateral_m = noise.first;
        options.pose_noise_yaw_rad = noise.second;
    }
    static void put(nlohmann::ordered_json& json, const SceneOptions& options, const std::string& /*place*/) {
        json["pose_noise"] = {options.pose_noise_lateral_m.value_or(0.0),
                              options.pose_noise_yaw_rad.value_or(0.0)};
    }
};

/// Of recorded options: their conditions have the names that the other options give them.
template <>
inline constexpr std::tuple kFields<SceneOptions>{
    Field{"fp", &SceneOptions::false_positive_rates},
    Field{"range", &SceneOptions::ranges_m},
    Field{"every", &SceneOptions::every_m},
    NumberOrZero{"noise", &SceneOptions::noise_sigma_m},
    PoseNoise{},
    NumberOrZero{"miss", &SceneOptions::miss_rate},
    Field{"color", &SceneOptions::with_color},
    Field{"color_error", &SceneOptions::color_error_rate},
    Field{"color_unknown", &SceneOptions::color_unknown_rate},
    Field{"confidence", &SceneOptions::with_confidence},
    Field{"seed", &SceneOptions::seed},
    Field{"condition", &SceneOptions::conditions, Absent::if_empty},
    Field{"noise_by_range", &SceneOptions::noise_by_range},
    Field{"persist", &SceneOptions::persistent},
    Field{"nearest", &SceneOptions::nearest}};

}  // namespace conelane
