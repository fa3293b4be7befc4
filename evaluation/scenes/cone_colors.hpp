#pragma once

#include "conelane/scene.hpp"
#include "evaluation/files/json_node.hpp"

namespace conelane {

/// Reads the keys `color` and `color_probabilities` of a cone, each of which may be absent. Where only the
/// probabilities are there, the label is the most probable one. Throws InputError.
void read_color(const JsonNode& json, Cone& cone);

/// The value of `color_probabilities`: [unknown, blue, yellow, orange, big orange].
[[nodiscard]] nlohmann::ordered_json color_probabilities_json(const ColorProbabilities& probabilities);

}  // namespace conelane
