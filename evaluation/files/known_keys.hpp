#pragma once

#include "evaluation/files/json_node.hpp"

#include <span>
#include <string>
#include <string_view>

namespace conelane {

/// The name that a misspelt one most likely means: two letters wrong, missing, too many or in the wrong case
/// at most. Empty where none is that near.
[[nodiscard]] std::string_view closest_name(std::string_view misspelt,
                                            std::span<const std::string_view> names);

/// Throws InputError where the object has a key that is not in `keys`. The error names the first such key and
/// the most similar known one.
void require_known_keys(const JsonNode& object, std::span<const std::string_view> keys);

}  // namespace conelane
