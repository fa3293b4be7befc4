#pragma once

#include "evaluation/formats/json_node.hpp"

#include <span>
#include <string>
#include <string_view>

namespace conelane {

/// The known name that a misspelt one most likely means: at most two letters wrong, missing, too many or in
/// the wrong case. Empty if there is none.
[[nodiscard]] std::string_view closest_name(std::string_view misspelt,
                                            std::span<const std::string_view> names);

/// Throws InputError if the object has a key that is not in `keys`. The error names the first such key and
/// the most similar known one.
void require_known_keys(const JsonNode& object, std::span<const std::string_view> keys);

}  // namespace conelane
