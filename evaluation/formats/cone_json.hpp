#pragma once

#include "conelane/scene.hpp"
#include "evaluation/formats/json_node.hpp"

#include <array>
#include <optional>

namespace conelane {

/// Reads the keys `color` and `color_probabilities` of a cone, each of which may be absent. Where only the
/// probabilities are there, the label is the most probable one. Throws InputError.
void read_color(const JsonNode& json, Cone& cone);

/// The value of `color_probabilities`: [unknown, blue, yellow, orange, big orange].
[[nodiscard]] nlohmann::ordered_json color_probabilities_json(const ColorProbabilities& probabilities);

/// The covariance that a matrix [xx, xy, yx, yy] holds. Nothing where xy and yx differ by more than 1e-6 of
/// the larger one; else xy is their mean.
[[nodiscard]] std::optional<PositionCovariance> covariance_of(const std::array<double, 4>& matrix);

/// Reads the key `position_covariance` of a cone, which may be absent. Throws InputError where it is not a
/// symmetric positive semidefinite matrix of two rows.
void read_covariance(const JsonNode& json, Cone& cone);

/// The value of `position_covariance`: [[xx, xy], [xy, yy]].
[[nodiscard]] nlohmann::ordered_json covariance_json(const PositionCovariance& covariance);

}  // namespace conelane
