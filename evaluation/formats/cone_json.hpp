#pragma once

#include "conelane/scene.hpp"
#include "evaluation/formats/json_records.hpp"

namespace conelane {

/// `color` and `color_probabilities` ([unknown, blue, yellow, orange, big orange]) of a cone, each of which
/// may be absent. Where only the probabilities are there, the label is the most probable one.
struct ConeColors {
    static void read(const JsonNode& json, Cone& cone);
    static void put(nlohmann::ordered_json& json, const Cone& cone, const std::string& place);
};

/// How uncertain a cone is: writes `color_probabilities`, reads and writes `position_covariance`, a symmetric
/// positive semidefinite matrix of two rows. Each may be absent.
struct ConeUncertainty {
    static void read(const JsonNode& json, Cone& cone);
    static void put(nlohmann::ordered_json& json, const Cone& cone, const std::string& place);
};

struct ConeX {
    decltype(auto) operator()(auto& placed) const { return placed.position.x(); }
};
struct ConeY {
    decltype(auto) operator()(auto& placed) const { return placed.position.y(); }
};
inline constexpr std::tuple kConePlace{Field{"x", ConeX{}}, Field{"y", ConeY{}}};

/// All but the id.
inline constexpr std::tuple kSeenCone = std::tuple_cat(
    kConePlace,
    std::tuple{ConeColors{}, Field{"confidence", &Cone::confidence, Absent::when_read}, ConeUncertainty{}});
inline constexpr std::tuple kConeId{Field{"id", &Cone::id}};

template <>
inline constexpr std::tuple kFields<Cone> = std::tuple_cat(kConeId, kSeenCone);
template <>
inline constexpr std::tuple kFields<Pose> = std::tuple_cat(kConePlace,
                                                           std::tuple{Field{"yaw", &Pose::yaw_rad}});

}  // namespace conelane
